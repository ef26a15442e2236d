#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "models/fpga/row_profile.h"
#include "models/kernels/gray_image.h"
#include "sw/process/child.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// The figures of a repeated run, as text for check_repeated(). `input`: see open_again().
std::string figures_of(platform::Statistics statistics, const Result& last, const RunInput& input);
// Throws std::runtime_error if these figures of the repetition differ from those of the run.
void check_repeated(const RecordedRun& run, const std::string& figures);

// Repeats a recorded run in a child process and records the rows of its frames, and what `run --record` does.
// The repetition is always at fidelity fast, because the figures do not depend on the fidelity.
class Rerun {
 public:
  // Takes text for the end of a file of `run --record`.
  using Record = std::function<void(const std::string& name, const std::string& text)>;
  // Starts the child. `run` outlives the object. With `record`, next() hands all files to it.
  explicit Rerun(const RecordedRun& run, Record record = nullptr);

  // A finished frame of the repeated run.
  struct Frame {
    std::uint64_t number = 0;  // number of the camera frame
    fpga::RowProfile rows;
    kernels::GrayImage disparity;  // empty without pixels
  };
  // Waits until next() would return without waiting, a signal has been caught, or the time is over. Returns
  // true in the first case.
  bool has_news(std::chrono::milliseconds wait) { return child_->has_news(wait); }
  // Waits for the next frame; nullopt after the last. Throws std::runtime_error if the run fails, or if its
  // figures differ from the recorded ones.
  std::optional<Frame> next();

 private:
  const RecordedRun& run_;
  Record record_;
  std::unique_ptr<process::Child> child_;
};

}  // namespace stereotlm::runs
