#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/search/allocation_search.h"

namespace stereotlm::cli {

// The disparities of the best allocations, which are the same: the number of allocations and of frames.
struct ComparedPixels {
  std::size_t allocations = 0;
  std::uint64_t frames = 0;
};

// The result of `allocate`, from which its text and its JSON document are made.
struct AllocationReport {
  const explore::AllocationSearch& search;
  const platform::BoardConfig& board;
  explore::AllocationSearch::BoundOf bound;  // that of the search
  std::string store;                         // path of the database; empty: it is not kept
  int most_banks = 0;
  double keep_percent = 0;
  std::vector<std::string> board_words;          // the board on a command line, without its allocation
  bool is_whole = false;                         // the search was not interrupted
  std::vector<explore::BestPlacement> all = {};  // of the search
  std::optional<explore::BestOfAll> best = {};   // of the search
  std::optional<ComparedPixels> pixels = {};     // nullopt if they were not compared
  std::optional<std::string> written = {};       // the board file with the best allocation
};

std::string allocation_report_text(const AllocationReport& report);

// The document of --json, see stats/document_schemas.cpp.
nlohmann::ordered_json allocation_report_document(const AllocationReport& report);

}  // namespace stereotlm::cli
