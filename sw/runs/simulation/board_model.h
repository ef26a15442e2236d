#pragma once

#include "platform/config/tables.h"
#include "sw/explore/optimise/search.h"

namespace stereotlm::runs {

// Evaluates the boards of a search. `tables`: of a calibration; null: each board has the identity.
explore::BoardModel board_model(const platform::Tables* tables);

}  // namespace stereotlm::runs
