#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/media/truth.h"
#include "sw/runs/result_folder.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/pair_source.h"

namespace stereotlm::calib {
struct Calibration;
}

namespace stereotlm::runs {

// All that a run works on, loaded and checked.
struct RunInput {
  platform::BoardConfig board;
  std::shared_ptr<const calib::Calibration> calibration;  // null: without
  platform::Tables tables;
  std::unique_ptr<PairSource> pairs;  // null: blank ones; only with timing_only
  bool camera = true;                 // --source camera, else preloaded
  bool fast = true;                   // --fidelity fast, else cycle
  bool timing_only = false;
  std::uint64_t frames = 1;              // to deliver
  std::optional<media::Truth> truth;     // of the pair that the last one shows
  std::string config_yaml;               // the text of that result file
  RecordedOptions described;             // what run.json says; frames: those asked for
  std::unique_ptr<ResultFolder> folder;  // null: nothing is written
};

}  // namespace stereotlm::runs
