#pragma once

#include <string>

#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// Reads the options of a run from the text of its run.json. Throws std::runtime_error if run_json() would not
// write exactly this text for the options; the message does not name the file.
RecordedOptions parse_run_json(const std::string& text);

}  // namespace stereotlm::runs
