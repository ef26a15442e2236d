#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "models/fpga/record/conflict_recorder.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

// Adds a frame to `sums`: cycles and accesses of each strip of results, the fill first. `sums` is empty
// before the first frame.
void add_frame(const fpga::FrameConflicts& frame, fpga::FrameConflicts& sums);

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
