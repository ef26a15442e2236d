#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "models/fpga/row_profile.h"
#include "sw/runs/progress.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/rerun.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::runs {

// The reasons why the rows and the pixels of two runs, A and B, cannot be compared. A reason is empty if they
// can.
struct DiffLimits {
  DiffLimits(const RecordedRun& a, const RecordedRun& b);

  std::string rows;
  std::string pixels;
};

// Repeats two recorded runs side by side and compares them: the rows of frames with the same number in the
// core, and the disparities of frames that show the same camera frame.
class FrameAlignment {
 public:
  // Starts both runs. All arguments outlive the object. `csv`: gets the compared rows; may be null. `record_a`
  // and `record_b`: what Rerun hands to a record; may be null.
  FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits, stats::RowsCsv* csv,
                 Rerun::Record record_a = nullptr, Rerun::Record record_b = nullptr);

  // Returns true when both runs have ended, and false at the first interrupt. Throws what Rerun::next()
  // throws.
  bool run();

  const stats::RowComparison& rows() const { return rows_; }
  const stats::PixelComparison& pixels() const { return pixels_; }

  // The last camera frame that both runs computed, and its disparities.
  struct CommonFrame {
    std::uint64_t number = 0;
    kernels::GrayImage a;
    kernels::GrayImage b;
  };
  const std::optional<CommonFrame>& last_common() const { return last_common_; }

 private:
  // One of the two runs, and the frames of it that are still to be compared.
  struct Side {
    Side(const RecordedRun& run, Rerun::Record record) : rerun(run, std::move(record)) {}

    Rerun rerun;
    std::optional<Rerun::Frame> ahead;  // next frame of the run; nullopt after the last
    std::deque<fpga::RowProfile> rows;  // rows of frames that the other run has not reached
  };

  bool read(Side& side);
  bool advance(Side& side, const Side& other);
  void compare_rows();

  const DiffLimits& limits_;
  stats::RowsCsv* csv_;
  std::uint64_t frames_;  // frames of the longer run
  stats::RowComparison rows_;
  stats::PixelComparison pixels_;
  std::optional<CommonFrame> last_common_;
  Side a_;
  Side b_;
  ProgressLine progress_;
};

}  // namespace stereotlm::runs
