#pragma once

#include "models/kernels/gray_image.h"
#include "platform/statistics.h"
#include "sw/cli/run_input.h"

namespace stereotlm::cli {

// Writes the result files, prints the table and, if any, the identities that do not hold. True if they all
// hold. Throws std::runtime_error if the files cannot be written; an earlier result is then as it was.
bool deliver(RunInput& input, const platform::Statistics& statistics, const kernels::GrayImage& disparity);

}  // namespace stereotlm::cli
