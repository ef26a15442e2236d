#pragma once

#include <string>

#include "sw/runs/frame_alignment.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::cli {

// The text that `diff` prints for two compared runs.
std::string diff_text(const runs::RecordedRun& a, const runs::RecordedRun& b,
                      const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

}  // namespace stereotlm::cli
