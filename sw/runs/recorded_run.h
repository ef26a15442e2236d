#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "models/fpga/record/row_recorder.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/figures/statistics.h"
#include "sw/process/child.h"
#include "sw/process/problems.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_json.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::runs {

// The content of a result folder of `run --out`: board, options and figures of the run.
struct RecordedRun {
  std::string argument;  // its name on the command line: "A"
  std::string folder;    // the folder as typed
  platform::BoardConfig board;
  std::string run_json;
  RecordedOptions options;  // from run.json
  std::string stats_json;
  platform::Statistics statistics;  // from stats.json, without accuracy
};

// Reads config.yaml, run.json and stats.json of the folder. Reports all problems and returns nullopt if there
// are any. `rule`: the beginning of the message for what is no result folder: "A must be a folder that run
// --out has written: ".
std::optional<RecordedRun> read_recorded_run(const std::string& argument, const std::string& folder,
                                             const std::string& rule, process::Problems& problems);

// The same, for `argument`, which must be a folder. Checks as well that every input file still exists with
// the recorded SHA-256.
std::optional<RecordedRun> load_recorded_run(const std::string& argument, const std::string& folder,
                                             process::Problems& problems);

// The name of a run in messages: "A 'results/demo/a'".
std::string name_of(const RecordedRun& run);

// Loads the input to repeat the run, and opens its pictures. Reports problems; if there are any, the result
// must not be used.
RunInput open_again(const RecordedRun& run, process::Problems& problems);

// The figures of a repeated run, as text for check_repeated(). `input`: see open_again().
std::string figures_of(platform::Statistics statistics, const Result& last, const RunInput& input);
// Throws std::runtime_error if these figures of the repetition differ from those of the run.
void check_repeated(const RecordedRun& run, const std::string& figures);

// Repeats a recorded run in a child process, and takes the rows and the disparities of its frames. The
// repetition is always at fidelity fast, because the figures do not depend on the fidelity.
class Rerun {
 public:
  // Starts the child. `run` outlives the object.
  explicit Rerun(const RecordedRun& run);

  // A finished frame of the repeated run.
  struct Frame {
    std::uint64_t number = 0;  // number of the camera frame
    fpga::RowProfile rows;
    kernels::GrayImage disparity;  // empty without pixels
  };
  // Waits until next() would return without waiting, a signal has been caught, or the time is over. Returns
  // true in the first case.
  bool has_news(std::chrono::milliseconds wait) { return child_.has_news(wait); }
  // Waits for the next frame; nullopt after the last. Throws std::runtime_error if the run fails, or if its
  // figures differ from the recorded ones.
  std::optional<Frame> next();

 private:
  const RecordedRun& run_;
  process::Child child_;
};

// Why the rows and the pixels of two runs, A and B, cannot be compared; empty if they can.
struct DiffLimits {
  DiffLimits(const RecordedRun& a, const RecordedRun& b);

  std::string rows;
  std::string pixels;
};

// Repeats two recorded runs side by side and compares them: the rows of frames with the same number in the
// core, and the disparities of frames that show the same camera frame.
class FrameAlignment {
 public:
  // Starts both runs. All arguments outlive the object. `csv`: gets the compared rows; may be null.
  FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits, stats::RowsCsv* csv);

  // Returns true when both runs have ended, false at the first interrupt. Throws as Rerun::next() does.
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
  struct AlignedRun {
    explicit AlignedRun(const RecordedRun& run) : rerun(run) {}

    Rerun rerun;
    std::optional<Rerun::Frame> ahead;  // next frame of the run; nullopt after the last
    std::deque<fpga::RowProfile> rows;  // rows of frames that the other run has not reached
  };

  bool read(AlignedRun& side);
  bool advance(AlignedRun& side, const AlignedRun& other);

  const DiffLimits& limits_;
  stats::RowsCsv* csv_;
  std::uint64_t frames_;  // frames of the longer run
  stats::RowComparison rows_;
  stats::PixelComparison pixels_;
  std::optional<CommonFrame> last_common_;
  AlignedRun a_;
  AlignedRun b_;
  ProgressLine progress_{"both runs are repeated"};
};

}  // namespace stereotlm::runs
