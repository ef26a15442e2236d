#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "platform/statistics.h"

namespace stereotlm::test {

// One frame of noise on a preset with `--set` options, and what the end of contract section 2 says of it.
struct WorkedFrame {
  std::string name;
  std::string preset;
  std::vector<std::string> sets;
  std::uint64_t frame_cycles;
  std::vector<std::string> blame = {};  // "left_lut in bank0 by left_pixel: 2137602"

  friend void PrintTo(const WorkedFrame& frame, std::ostream* out) { *out << frame.name; }
};

inline std::string name_of(const testing::TestParamInfo<WorkedFrame>& info) { return info.param.name; }

// Simulates the frame. Expects its cycles and its blame, the disparity image of the kernels on whole images,
// no failed identity and a rate within the bound. Once per process.
platform::Statistics expect_worked_values(const WorkedFrame& frame);

using CoreWorkedValues = testing::TestWithParam<WorkedFrame>;

}  // namespace stereotlm::test
