#pragma once

#include <string>

#include "platform/config/board_config.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {

// What `explain` prints of a board that has been simulated.
std::string explanation_text(const platform::BoardConfig& board, runs::Explanation& explanation);

// The share of the cycles, in percent, in which the matcher waits for places in the result queue; 0 if it does
// not limit the board. No bound counts these places. If the queue is too short, the core is slower than the
// bound of the matcher though no port waits for a bank, and the ports that fill the lanes are blocked.
double result_queue_percent(runs::Explanation& explanation);

}  // namespace stereotlm::cli
