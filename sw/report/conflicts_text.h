#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "models/fpga/record/conflict_recorder.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

// Adds a frame to `sums`: cycles and accesses of each strip of results, the fill first. `sums` is empty
// before the first frame.
void add_frame(const fpga::FrameConflicts& frame, fpga::FrameConflicts& sums);

// What `conflicts --json` prints of a run (stats/document_schemas.cpp): who waits where for whom,
// the longest wait first. For each wait the shortest range of rows, and that of columns, with 80 % of it; a
// range of 75 % of the picture or more is left out. Then how busy the used banks are from top to bottom.
nlohmann::ordered_json conflicts_document(const platform::BoardConfig& board,
                                          const fpga::ConflictRecorder& recorder,
                                          const fpga::FrameConflicts& sums);

// The document as text.
std::string conflicts_text(const nlohmann::ordered_json& document);

}  // namespace stereotlm::report
