#pragma once

#include <nlohmann/json.hpp>

#include "platform/config/board_config.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {

// The document of `explain --json`, of a board that has been simulated. Its schema is
// sw/cli/schemas/explain.schema.json.
nlohmann::ordered_json explanation_document(const platform::BoardConfig& board,
                                            runs::Explanation& explanation);

}  // namespace stereotlm::cli
