#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/plain_cycle_loop.h"

// The worked values of contract section 8 (lanes; stripes and SDRAM are to come), from the plain core.
namespace stereotlm::test {

inline constexpr int kLog7Half = 3;

struct WorkedBoard {
  std::string name;
  PlainCycleInput board;
  std::vector<std::uint64_t> frame_cycles;  // of the first frames
};
inline void PrintTo(const WorkedBoard& worked, std::ostream* out) { *out << worked.name; }
inline std::string name_of_case(const testing::TestParamInfo<WorkedBoard>& suite) { return suite.param.name; }

inline void expect_worked_cycles(const WorkedBoard& worked) {
  const auto frames = static_cast<int>(worked.frame_cycles.size());
  EXPECT_EQ(run_plain_cycle_loop(worked.board, frames).frame_cycles, worked.frame_cycles);
}

using Change = std::function<void(PlainCycleInput&)>;

}  // namespace stereotlm::test
