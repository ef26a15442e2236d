#pragma once

#include "platform/config/tables.h"
#include "sw/explore/optimise/search.h"
#include "sw/runs/simulation/point_quality.h"

namespace stereotlm::runs {

// Evaluates the boards of a search. `tables`: of a calibration; null: each board has the identity. `quality`:
// of the pictures of the plan.
explore::BoardModel board_model(const platform::Tables* tables, PointQuality quality = {});

}  // namespace stereotlm::runs
