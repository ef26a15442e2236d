#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/checked.h"
#include "models/kernels/filter_kernel.h"
#include "models/kernels/limits.h"
#include "models/kernels/matching_cost.h"

namespace stereotlm::fpga {

// How the core simulates a frame. Results and times are the same at every fidelity.
enum class Fidelity : std::uint8_t {
  kCycle,        // cycle by cycle, every access a transaction
  kCycleTiming,  // as kCycle, but no disparities are computed
  kFast,         // data in one step, by direct access; cycles fast-forwarded (FastForward)
  kTiming,       // as kFast, but without pictures and disparities
};
constexpr bool steps_cycles(Fidelity fidelity) {  // whether each cycle is stepped
  return fidelity == Fidelity::kCycle || fidelity == Fidelity::kCycleTiming;
}
constexpr bool has_pixels(Fidelity fidelity) {  // whether disparities are computed
  return fidelity == Fidelity::kCycle || fidelity == Fidelity::kFast;
}

// How the pixels of a window are fetched.
enum class Fetch : std::uint8_t {
  kColumn,      // n pixels of a column, one per cycle (paper section 3.2)
  kLineBuffer,  // one pixel per cycle, older rows from block RAM
};

// The word cache of a lane (contract 7.4).
enum class PixelCache : std::uint8_t {
  kNone,
  kWord,  // keeps the last word that was read, for each slot of a column
};

inline constexpr kernels::IntegerRule kWidthRule{4, 8192, 4};  // without a look-up table
inline constexpr kernels::IntegerRule kHeightRule{1, 8192};    // without a look-up table
// With a look-up table: its entries hold coordinates of 11 bits.
inline constexpr kernels::IntegerRule kWidthWithTableRule{4, 2048, 4};
inline constexpr kernels::IntegerRule kHeightWithTableRule{1, 2048};
inline constexpr kernels::IntegerRule kUnitsRule{1, 254};
inline constexpr kernels::IntegerRule kRowsRule{1, 16};
inline constexpr kernels::IntegerRule kLaneFifoRule{1, 64};
inline constexpr kernels::IntegerRule kResultFifoRule{1, 64};
inline constexpr kernels::IntegerRule kResultDelayRule{0, 64};
inline constexpr kernels::IntegerRule kPipelineLatencyRule{0, 1024};
inline constexpr kernels::IntegerRule kLanesRule{1, 16};
inline constexpr kernels::IntegerRule kStripeRule{2, 16};  // parts

// The parameters that the FPGA is synthesised with. Defaults: the board of the paper.
struct CoreConfig {
  int width = 640;           // pixels, kWidthRule; with a look-up table kWidthWithTableRule
  int height = 480;          // pixels, kHeightRule; with a look-up table kHeightWithTableRule
  int window = 7;            // n: kWindowRule
  int disparities = 80;      // D: candidates, kDisparitiesRule
  std::optional<int> units;  // U: window modules, kUnitsRule, at most D; nullopt: one for each candidate
  int rows = 1;              // R: rows of results computed at once, kRowsRule; more than 1 only with kColumn
  kernels::MatchingCost cost;                                     // of the matcher
  std::optional<kernels::FilterKernel> filter = kernels::log7();  // nullopt: no filter
  Fetch fetch = Fetch::kColumn;                                   // the order of the slots
  std::optional<int> lr_tolerance = 0;  // kLrToleranceRule; nullopt: no left-right check
  bool left_table = true;               // false: the side has no look-up table
  bool right_table = true;              // false: the side has no look-up table
  bool joint_tables = false;            // one table for both sides, which both have one then (contract 7.3)
  PixelCache pixel_cache = PixelCache::kNone;  // of each lane
  // The striped buffers (contract 8.2), each as the bases of its parts: bits 31..26 bank, 25..0 first word.
  // All banks of a buffer differ, and have one read latency.
  std::vector<std::vector<std::uint32_t>> stripes;
  int lanes = 1;                     // P: lanes of each side, kLanesRule; more than 1 only with kColumn
  double clock_mhz = 40;             // 1..1000
  int lane_fifo_slots = 16;          // slots, kLaneFifoRule
  int result_fifo_words = 8;         // 32-bit words, kResultFifoRule, at least `rows`
  int result_delay_cycles = 0;       // Q: cycles, kResultDelayRule, before the result queue (contract 7.11)
  int pipeline_latency_cycles = 16;  // cycles, kPipelineLatencyRule, after the last write
};

// U, the number of window modules, and S, the number of cycles in which the matcher works on a slot (contract
// 7.1).
inline int units_of(const CoreConfig& config) { return config.units.value_or(config.disparities); }
inline int folds_of(int disparities, int units) { return (disparities + units - 1) / units; }
inline int folds_of(const CoreConfig& config) { return folds_of(config.disparities, units_of(config)); }

// The rules between parameters (contract 7.1, 7.2, 8.1).
inline bool has_units_for(std::optional<int> units, int disparities) {
  return !units || *units <= disparities;
}
// Several rows or lanes only with kColumn; each row has a place in the result queue.
inline bool can_fetch_rows(Fetch fetch, int rows) { return fetch == Fetch::kColumn || rows == 1; }
inline bool can_queue_rows(int result_fifo_words, int rows) { return result_fifo_words >= rows; }
inline bool can_divide_columns(Fetch fetch, int lanes) { return fetch == Fetch::kColumn || lanes == 1; }

// Every broken rule as `field = value: rule`; empty if the core can be built.
std::vector<std::string> problems(const CoreConfig& config);

}  // namespace stereotlm::fpga
