#pragma once

#include "models/fpga/conflict_recorder.h"
#include "platform/trace_records.h"

namespace stereotlm::platform {

// The runs of a frame of the core: its grants and its stalls, strip by strip.
FrameRuns frame_runs(const fpga::FrameConflicts& frame);

}  // namespace stereotlm::platform
