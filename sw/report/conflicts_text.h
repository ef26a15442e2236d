#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

// Cycles and accesses of each strip of results, the fill first, summed over frames.
class StripSums {
 public:
  void add(const fpga::FrameConflicts& frame);
  const fpga::FrameConflicts& sums() const { return sums_; }

 private:
  fpga::FrameConflicts sums_;
};

// First and last row or column, both included.
struct Range {
  int first = 0;
  int last = 0;
};

// What `conflicts` says of a run: who waits where for whom, and where in the picture; how busy the banks are
// from top to bottom.
struct ConflictSummary {
  // A port that waits at a bank. The ranges are the first of the shortest ones of rows and
  // columns that have 80 % of its cycles; nullopt if that is most of the picture.
  struct Wait {
    std::string port;
    std::string bank;
    std::string by;  // as in stats.json, with the host's traffic by its three names
    std::uint64_t cycles = 0;
    double cycles_percent = 0;
    bool is_in_fill = false;  // all of it is before the first row of results
    std::optional<Range> rows = std::nullopt;
    std::optional<Range> columns = std::nullopt;
  };
  // A band of rows of the picture.
  struct Band {
    std::optional<Range> rows;  // nullopt: the fill
    double waits_percent = 0;   // of its cycles
    std::vector<double> banks_percent;
  };

  std::string board;
  std::uint64_t frames = 0;
  std::uint64_t cycles = 0;
  std::vector<Wait> waits;         // the longest first
  std::vector<std::string> banks;  // those that are used
  std::vector<Band> bands;         // from top to bottom
};
ConflictSummary conflict_summary(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                                 const fpga::FrameConflicts& sums);

// The summary as text, and as the document of `conflicts --json`, whose schema is
// sw/cli/schemas/conflicts.schema.json.
std::string conflicts_text(const ConflictSummary& summary);
nlohmann::ordered_json conflicts_document(const ConflictSummary& summary);

}  // namespace stereotlm::report
