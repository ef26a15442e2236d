#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "models/fpga/row_profile.h"
#include "models/kernels/gray_image.h"
#include "sw/process/child.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::runs {

// Repeats a recorded run in a child process and records the rows of its frames. Always at fidelity fast: the
// figures do not depend on the fidelity.
class Rerun {
 public:
  // Starts the child. `run` outlives the object.
  explicit Rerun(const RecordedRun& run);

  struct Frame {
    std::uint64_t number = 0;  // number of the camera frame
    fpga::RowProfile rows;
    kernels::GrayImage disparity;  // empty without pixels
  };
  // Waits until next() has a frame, for at most this time or until a signal is caught. Returns whether it
  // has.
  bool has_news(std::chrono::milliseconds wait) { return child_->has_news(wait); }
  // Waits for the next frame; nullopt after the last. Throws std::runtime_error if the run fails, or if its
  // figures differ from the recorded ones.
  std::optional<Frame> next();

 private:
  void check_figures(const std::string& stats_json) const;

  const RecordedRun& run_;
  std::unique_ptr<process::Child> child_;
};

}  // namespace stereotlm::runs
