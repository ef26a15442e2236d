#pragma once

#include <string>

#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// The options of a run, from the text of its run.json. Throws std::runtime_error, without the name of the
// file, if it is not what run_json() writes of the options of a run, byte for byte.
RecordedOptions parse_run_json(const std::string& text);

}  // namespace stereotlm::runs
