#pragma once

#include <string>

#include "sw/cli/frame_alignment.h"
#include "sw/cli/recorded_run.h"

namespace stereotlm::cli {

// What `diff` prints of two runs, once they are aligned.
std::string diff_text(const RecordedRun& a, const RecordedRun& b, const FrameAlignment& aligned,
                      const DiffLimits& limits);

}  // namespace stereotlm::cli
