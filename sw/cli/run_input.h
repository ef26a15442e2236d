#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "platform/board_config.h"
#include "platform/tables.h"
#include "sw/cli/pair_source.h"
#include "sw/cli/run_options.h"
#include "sw/media/truth.h"
#include "sw/report/result_folder.h"
#include "sw/report/run_json.h"

namespace stereotlm::calib {
struct Calibration;
}

namespace stereotlm::cli {

// All that a run works on, loaded and checked.
struct RunInput {
  platform::BoardConfig board;
  std::shared_ptr<const calib::Calibration> calibration;  // null: without
  platform::Tables tables;
  std::unique_ptr<PairSource> pairs;  // null: blank ones; only with timing_only
  bool camera = true;                 // --source camera, else preloaded
  bool fast = true;                   // --fidelity fast, else cycle
  bool timing_only = false;
  std::uint64_t frames = 1;                      // to deliver
  std::optional<media::Truth> truth;             // of the pair that the last one shows
  std::string config_yaml;                       // the text of that result file
  report::RunOptions described;                  // what run.json says; frames: those asked for
  std::unique_ptr<report::ResultFolder> folder;  // null: nothing is written
};

// Throws Refused with everything that is wrong. Says on standard error which pictures were converted to grey.
// Once the pictures are checked, which may take long, interrupts are caught; before, they end the process,
// which has changed nothing.
RunInput load_run_input(const RunOptions& options);

}  // namespace stereotlm::cli
