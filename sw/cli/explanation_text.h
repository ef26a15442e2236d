#pragma once

#include <string>

#include "platform/config/board_config.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {

// What `explain` prints of a board that has been simulated.
std::string explanation_text(const platform::BoardConfig& board, runs::Explanation& explanation);

}  // namespace stereotlm::cli
