#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "platform/config/board_config.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {

// What `explain` prints of a board that has been simulated.
std::string explanation_text(const platform::BoardConfig& board, runs::Explanation& explanation);

// The document of `explain --json`. Its schema is sw/cli/schemas/explain.schema.json.
nlohmann::ordered_json explanation_document(const platform::BoardConfig& board,
                                            runs::Explanation& explanation);

}  // namespace stereotlm::cli
