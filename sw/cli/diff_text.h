#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sw/runs/frame_alignment.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::cli {

// The text that `diff` prints for two compared runs.
std::string diff_text(const runs::RecordedRun& a, const runs::RecordedRun& b,
                      const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

// What `diff --json` prints: settings, options, figures, cycles of frames, waits and rows that differ, each as
// B - A or with both values, and the last sentence of the text.
nlohmann::ordered_json diff_document(const runs::RecordedRun& a, const runs::RecordedRun& b,
                                     const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

}  // namespace stereotlm::cli
