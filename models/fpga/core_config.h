#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/kernels/filter_kernel.h"
#include "models/kernels/limits.h"

namespace stereotlm::fpga {

enum class Fetch : std::uint8_t {
  kColumn,      // n pixels of a column, one a cycle (paper section 3.2)
  kLineBuffer,  // one pixel a cycle, older rows from block RAM
};

inline constexpr kernels::IntegerRule kWidthRule{4, 2048, 4};
inline constexpr kernels::IntegerRule kHeightRule{1, 2048};
inline constexpr kernels::IntegerRule kLaneFifoRule{1, 64};
inline constexpr kernels::IntegerRule kResultFifoRule{1, 64};
inline constexpr kernels::IntegerRule kPipelineLatencyRule{0, 1024};

// The parameters that the FPGA is synthesised with. Defaults: the board of the paper.
struct CoreConfig {
  int width = 640;                                                // pixels, kWidthRule
  int height = 480;                                               // pixels, kHeightRule
  int window = 7;                                                 // n: kWindowRule
  int disparities = 80;                                           // D: window modules, kDisparitiesRule
  std::optional<kernels::FilterKernel> filter = kernels::log7();  // nullopt: no filter
  Fetch fetch = Fetch::kColumn;
  std::optional<int> lr_tolerance = 0;  // kLrToleranceRule; nullopt: no left-right check
  bool left_table = true;               // false: the left side has no look-up table
  bool right_table = true;
  double clock_mhz = 40;             // 1..1000
  int lane_fifo_slots = 16;          // slots, kLaneFifoRule
  int result_fifo_words = 8;         // 32-bit words, kResultFifoRule
  int pipeline_latency_cycles = 16;  // cycles, kPipelineLatencyRule, after the last write
};

// Every broken rule as `field = value: rule`; empty if the core can be built.
std::vector<std::string> problems(const CoreConfig& config);

}  // namespace stereotlm::fpga
