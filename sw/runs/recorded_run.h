#pragma once

#include <optional>
#include <string>

#include "platform/config/board_config.h"
#include "sw/process/problems.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_json.h"

namespace stereotlm::runs {

// What a result folder of `run --out` says: with which board and options the run was made, and its figures.
struct RecordedRun {
  std::string argument;  // the word of the command line for it: "A"
  std::string folder;    // as it was named
  platform::BoardConfig board;
  std::string run_json;
  RecordedOptions options;  // as run_json says
  std::string stats_json;
};

// Reads config.yaml, run.json and stats.json of the folder and checks that every input is there, with its
// SHA-256. Nothing if it is not so, with every reason reported.
std::optional<RecordedRun> load_recorded_run(const std::string& argument, const std::string& folder,
                                             process::Problems& problems);

// "A 'results/demo/a'"
std::string name_of(const RecordedRun& run);

// What it takes to run it again, with its pictures opened. Reports what is wrong: the result is good for
// nothing then.
RunInput open_again(const RecordedRun& run, process::Problems& problems);

}  // namespace stereotlm::runs
