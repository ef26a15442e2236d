#pragma once

#include <memory>
#include <optional>
#include <string>

#include "models/host/ideal_host.h"
#include "platform/board_config.h"
#include "platform/tables.h"
#include "sw/cli/run_options.h"
#include "sw/media/truth.h"
#include "sw/report/result_folder.h"
#include "sw/report/run_json.h"

namespace stereotlm::cli {

// All that a run works on, loaded and checked.
struct RunInput {
  platform::BoardConfig board;
  platform::Tables tables;
  host::StereoPair pair;
  std::optional<media::Truth> truth;
  std::string config_yaml;                       // the text of that result file
  report::RunOptions described;                  // what run.json says; frames: those asked for
  std::unique_ptr<report::ResultFolder> folder;  // null: nothing is written
};

// Throws Refused with everything that is wrong. Says on standard error which pictures were converted to grey.
RunInput load_run_input(const RunOptions& options);

}  // namespace stereotlm::cli
