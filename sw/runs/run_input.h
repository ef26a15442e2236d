#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/record/core_cycle.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/files/output_file.h"
#include "sw/files/output_folder.h"
#include "sw/media/load.h"
#include "sw/runs/run_json.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/runs/sources/open_source.h"
#include "sw/trace/trace.h"

namespace stereotlm::calib {
struct Calibration;
}

namespace stereotlm::runs {

// The inputs of a run, loaded and checked.
struct RunInput {
  platform::BoardConfig board;
  std::shared_ptr<const calib::Calibration> calibration;  // null: no calibration
  platform::Tables tables;
  std::unique_ptr<PairSource> pairs;  // with timing_only blank_pairs()
  bool camera = true;                 // --source camera, else preloaded
  bool fast = true;                   // --fidelity fast, else cycle
  bool timing_only = false;
  std::uint64_t recorded_frames = 0;  // whose waits are written to the folder; 0: none
  bool json = false;                  // --json
  // Gets whole lines of each file that the run records (sw/report/README.md); null: it records nothing.
  std::function<void(const std::string& name, const std::string& text)> record;
  std::unique_ptr<trace::Trace> trace;          // null: no --trace
  std::uint64_t frames = 1;                     // frames to deliver
  std::optional<media::Truth> truth;            // ground truth of the pair that the last frame shows
  std::vector<files::NamedFile> inputs;         // the files that it is read from
  RecordedOptions described;                    // content of run.json; `frames` as requested
  std::unique_ptr<files::OutputFolder> folder;  // null: no result files

  // The mode of the simulation.
  RunMode mode() const {
    return {camera, fidelity(fast), frames, trace != nullptr ? kAllFrames : recorded_frames};
  }
  fpga::Fidelity fidelity(bool at_fast) const {
    if (at_fast) return timing_only ? fpga::Fidelity::kTiming : fpga::Fidelity::kFast;
    return timing_only ? fpga::Fidelity::kCycleTiming : fpga::Fidelity::kCycle;
  }
};

}  // namespace stereotlm::runs
