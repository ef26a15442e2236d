#pragma once

#include <string>

#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// Reads the options of a run from the text of its run.json. Throws std::runtime_error, without the file's name,
// if run_json() does not write exactly this text.
RecordedOptions parse_run_json(const std::string& text);

}  // namespace stereotlm::runs
