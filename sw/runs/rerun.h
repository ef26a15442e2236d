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

// A recorded run, run again in a process of its own, with the rows of its frames. At fidelity fast, whichever
// it was run at: the figures are the same.
class Rerun {
 public:
  // Begins. `run` outlives it.
  explicit Rerun(const RecordedRun& run);

  struct Frame {
    std::uint64_t number = 0;  // of the camera frame
    fpga::RowProfile rows;
    kernels::GrayImage disparity;  // empty without pixels
  };
  // Waits for as long at most, or until a signal has been caught, and tells whether next() has something to
  // say.
  bool has_news(std::chrono::milliseconds wait) { return child_->has_news(wait); }
  // Waits for the next frame; nothing after the last. Throws std::runtime_error if the run fails, or ends
  // with other figures than those recorded.
  std::optional<Frame> next();

 private:
  void check_figures(const std::string& stats_json) const;

  const RecordedRun& run_;
  std::unique_ptr<process::Child> child_;
};

}  // namespace stereotlm::runs
