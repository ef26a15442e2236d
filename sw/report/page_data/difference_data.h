#pragma once

#include <nlohmann/json.hpp>

#include "platform/config/board_config.h"
#include "sw/runs/frame_alignment.h"

namespace stereotlm::report {

// The part `difference` of a page's data (sw/report/page/README.md): two compared runs
// with images of this size.
nlohmann::ordered_json difference_data(const platform::ImageConfig& image,
                                       const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

}  // namespace stereotlm::report
