#pragma once

#include "models/host/frame_source.h"
#include "sw/runs/run_input.h"

namespace stereotlm::runs {

// Prints a warning if both pictures are the same. With a calibration, prints how well the rows of the
// rectified pictures match. A poor match gives a warning: the pictures may be exchanged or of another rig,
// which the file of a calibration does not reveal.
void check_pair(const RunInput& input, const host::StereoPair& pair);

// Prints a note if the pictures of a pair are surely exchanged, for a run without calibration. Takes about
// 0.2 s at 640x480.
void say_if_exchanged(const RunInput& input, const host::StereoPair& pair);

}  // namespace stereotlm::runs
