#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/kernels/filter_kernel.h"

namespace stereotlm::fpga {

enum class Fetch : std::uint8_t {
  kColumn,      // n pixels of a column, one a cycle (paper section 3.2)
  kLineBuffer,  // one pixel a cycle, older rows from block RAM
};

// What the FPGA is synthesised for. Defaults: the paper's board.
struct CoreConfig {
  int width = 640;                                                // pixels, 4..2048, a multiple of 4
  int height = 480;                                               // pixels, 1..2048
  int window = 7;                                                 // n: odd, 3..31
  int disparities = 80;                                           // D: window modules, 1..254
  std::optional<kernels::FilterKernel> filter = kernels::log7();  // nullopt: no filter
  Fetch fetch = Fetch::kColumn;
  std::optional<int> lr_tolerance = 0;  // disparities, 0..253; nullopt: no left-right check
  bool left_table = true;               // false: the left side has no look-up table
  bool right_table = true;
  double clock_mhz = 40;             // 1..1000
  int lane_fifo_slots = 16;          // slots, 1..64
  int result_fifo_words = 8;         // 32-bit words, 1..64
  int pipeline_latency_cycles = 16;  // cycles, 0..1024, after the last write
};

// Every broken rule as `field = value: rule`; empty if the core can be built.
std::vector<std::string> problems(const CoreConfig& config);

}  // namespace stereotlm::fpga
