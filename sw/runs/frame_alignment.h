#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "models/fpga/row_profile.h"
#include "sw/report/pixel_comparison.h"
#include "sw/report/row_comparison.h"
#include "sw/report/rows_csv.h"
#include "sw/runs/progress.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/rerun.h"

namespace stereotlm::runs {

// Why two runs, A and B, cannot be compared so far; empty: they can.
struct DiffLimits {
  DiffLimits(const RecordedRun& a, const RecordedRun& b);

  std::string rows;
  std::string pixels;
};

// Two runs, run again and laid beside each other: rows where they are of the same frame of the core,
// disparities where they are of the same camera frame.
class FrameAlignment {
 public:
  // Begins both. All outlives it; `csv` may be null.
  FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits, report::RowsCsv* csv);

  // Until both have ended, or the first interrupt: false then. Throws what Rerun::next() throws.
  bool run();

  const report::RowComparison& rows() const { return rows_; }
  const report::PixelComparison& pixels() const { return pixels_; }

 private:
  // One of the two, a frame ahead.
  struct Side {
    explicit Side(const RecordedRun& run) : rerun(run) {}

    Rerun rerun;
    std::optional<Rerun::Frame> ahead;
    std::deque<fpga::RowProfile> rows;  // of frames that the other has not come to
  };

  bool read(Side& side);
  bool advance(Side& side, const Side& other);
  void compare_rows();

  const DiffLimits& limits_;
  report::RowsCsv* csv_;
  std::uint64_t frames_;  // of the longer one
  report::RowComparison rows_;
  report::PixelComparison pixels_;
  Side a_;
  Side b_;
  ProgressLine progress_;
};

}  // namespace stereotlm::runs
