#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/optimise/search.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::cli {

// Allocations tie if none of them is known to be slower than another.

// The rate of an allocation: of the core alone, or the steady rate of a whole computer.
struct AllocationRate {
  double frames_per_second = 0;
  double uncertainty = 0;    // of a steady rate
  std::uint64_t cycles = 0;  // of the core, of all frames, with the latency of the pipeline
};

// Allocations with the same rate.
struct RatedAllocations {
  std::uint64_t count = 0;
  platform::BoardConfig first;  // in the order of the placements
  AllocationRate rate;
  explore::Range possible;  // in which the rate of a long run lies
};

// The best of the allocations that use a given number of banks.
struct BestAllocations {
  int banks = 0;
  std::uint64_t allocations = 0;            // that use so many banks
  std::vector<RatedAllocations> ties = {};  // the fastest first; empty: none counts
  double bound = 0;                         // of the rate of the first of `ties`

  std::uint64_t tied() const;
};

// The allocations that tie for the best of all.
struct BestOfAll {
  std::uint64_t tied = 0;
  AllocationRate highest;                     // the highest rate of one that ties
  double possible_frames_per_second = 0;      // none that ties can have more
  int banks = 0;                              // the fewest banks of one that ties
  const RatedAllocations* fastest = nullptr;  // of those with so few banks
};

// The disparities of the best allocations, which are the same: the number of allocations and of frames.
struct ComparedPixels {
  std::size_t allocations = 0;
  std::uint64_t frames = 0;
};

// The result of `allocate`, from which its text and its JSON document are made.
struct AllocationReport {
  const platform::BoardConfig& board;
  explore::PointRun run;
  int most_banks = 0;
  double keep_percent = 0;
  std::vector<std::string> board_words;       // the board on a command line, without its allocation
  std::uint64_t simulated = 0;                // runs
  bool is_whole = false;                      // the search was not interrupted
  double open_bound = 0;                      // of the rate of those that are not decided; 0: all are
  std::vector<BestAllocations> all = {};      // for each number of banks that can hold the buffers
  std::optional<ComparedPixels> pixels = {};  // nullopt if they were not compared
  std::optional<std::string> written = {};    // the board file with the best allocation

  std::uint64_t allocations() const;
  // nullopt if none counts.
  std::optional<BestOfAll> best() const;
};

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

std::string allocation_report_text(const AllocationReport& report);

// The document of --json, see stats/document_schemas.cpp.
nlohmann::ordered_json allocation_report_document(const AllocationReport& report);

}  // namespace stereotlm::cli
