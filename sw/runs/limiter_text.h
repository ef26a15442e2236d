#pragma once

#include <optional>
#include <string>

#include "sw/runs/explanation.h"

namespace stereotlm::runs {

// The longest wait of a port of the core, at this resource ("bank bank0") or at any bank. Waits of the host do not
// count: they cost the core nothing.
std::optional<explore::StoredBlame> longest_wait(Explanation& explanation, const std::string& resource = "");

// Why a board is not faster, after "limited by": "the matcher, at its bound of 18.596 frames/s".
std::string limiter_text(Explanation& explanation);

// What the time of a frame goes to: "96.69 % the matcher and the ports, 3.31 % the core waits for ..".
std::string budget_text(Explanation& explanation);

// The share of the cycles in which the matcher waits because the result queue is too short, in percent; 0 if
// it does not limit the board.
double result_queue_percent(Explanation& explanation);

}  // namespace stereotlm::runs
