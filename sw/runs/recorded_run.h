#pragma once

#include <optional>
#include <string>

#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "sw/process/problems.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// The content of a result folder of `run --out`: board, options and figures of the run.
struct RecordedRun {
  std::string argument;  // its name on the command line: "A"
  std::string folder;    // the folder as typed
  platform::BoardConfig board;
  std::string run_json;
  RecordedOptions options;  // from run.json
  std::string stats_json;
  platform::Statistics statistics;  // from stats.json, without accuracy
};

// Reads config.yaml, run.json and stats.json of the folder. Reports all problems and returns nullopt if there
// are any. `rule`: the beginning of the message for what is no result folder: "A must be a folder that run
// --out has written: ".
std::optional<RecordedRun> read_recorded_run(const std::string& argument, const std::string& folder,
                                             const std::string& rule, process::Problems& problems);

// The same, for `argument`, which must be a folder. Checks as well that every input file still exists with
// the recorded SHA-256.
std::optional<RecordedRun> load_recorded_run(const std::string& argument, const std::string& folder,
                                             process::Problems& problems);

// Which version has written a run, if it is not this one: a part of messages.
std::string version_note(const RecordedOptions& options);

// The name of a run in messages: "A 'results/demo/a'".
std::string name_of(const RecordedRun& run);

// Loads the input to repeat the run, and opens its pictures. Reports problems; if there are any, the result
// must not be used.
RunInput open_again(const RecordedRun& run, process::Problems& problems);

}  // namespace stereotlm::runs
