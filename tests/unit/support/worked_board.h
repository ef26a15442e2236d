#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "models/kernels/rectification_table.h"
#include "platform/loop/core_loop.h"
#include "tests/support/board_of_random.h"
#include "tests/support/plain_cycle_loop.h"

// The worked values of contract section 8, from the plain core and from the platform.
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
  PlainCycleInput board = worked.board;
  const auto identity = kernels::identity_table(board.width, board.height).entries;
  if (board.left_lut && !board.left_table) board.left_table = identity;
  if (board.right_lut && !board.right_table) board.right_table = identity;
  const platform::Statistics found =
      platform::run_core(board_config(board), board_tables(board), worked.frame_cycles.size());
  EXPECT_EQ(found.frame_cycles, worked.frame_cycles);
  EXPECT_THAT(found.failed, testing::ElementsAre());
}

using Change = std::function<void(PlainCycleInput&)>;

}  // namespace stereotlm::test
