#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/statistics.h"

namespace stereotlm::test {

// One frame of noise on a preset with `--set` options. Expects the disparity image of the kernels on whole
// images, no failed identity and a rate within the bound. Once per process.
platform::Statistics run_one_frame(const std::string& preset, const std::vector<std::string>& sets);

using Cycles = std::vector<std::uint64_t>;

// "left_lut in bank0 by left_pixel: 2137602" for every row.
std::vector<std::string> blame_of(const platform::Statistics& statistics);

}  // namespace stereotlm::test
