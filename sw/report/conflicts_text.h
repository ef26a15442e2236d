#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

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

// What `conflicts` says of a run, as `conflicts --json` prints it: who waits where for whom, the longest wait
// first, and where in the picture: the first of the shortest ranges of rows and columns that have 80 % of the
// wait, left out if that is most of the picture; how busy the banks that are used are from top to bottom. Its
// schema is sw/cli/schemas/conflicts.schema.json.
nlohmann::ordered_json conflicts_document(const platform::BoardConfig& board,
                                          const fpga::ConflictRecorder& recorder,
                                          const fpga::FrameConflicts& sums);

// The document as text.
std::string conflicts_text(const nlohmann::ordered_json& document);

}  // namespace stereotlm::report
