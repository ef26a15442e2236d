#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/cli/board_options.h"
#include "sw/cli/options.h"
#include "sw/process/problems.h"
#include "sw/runs/run_input.h"
#include "sw/runs/sources/open_source.h"
#include "sw/trace/trace.h"

namespace stereotlm::cli {

// The options --trace and --trace-window.
class TraceOptions {
 public:
  explicit TraceOptions(Options* of);

  // Reports a trace that is none, or whose files another trace writes too, and a vcd without a window.
  void check_together(process::Problems& problems) const;
  // Reports a window outside the images of the board, or after the last of `frames` frames.
  void check_window(const platform::BoardConfig& board, std::uint64_t frames,
                    process::Problems& problems) const;

  // The traces, without those that are none.
  std::vector<trace::TraceFile> files() const;
  // nullopt if there is no window.
  std::optional<trace::TraceWindow> window() const;

 private:
  Option files_;
  Option window_;
};

// The options --truth and --truth-scale.
class TruthOptions {
 public:
  // `picture`: the picture whose truth it is, for the help.
  TruthOptions(Options* of, const std::string& picture);

  std::optional<std::string> file() const { return file_.if_given(); }
  double scale() const { return scale_.number<double>().value_or(1); }  // grey levels per disparity

 private:
  Option file_;
  Option scale_;
};

// The options that select the pictures of a run.
class PictureOptions {
 public:
  explicit PictureOptions(Options* of);

  bool is_given() const { return !sources_given().empty() || video_layout_.is_given(); }
  // Reports a missing source of pictures, unless `may_be_missing`, and a pair with one side. Returns whether
  // nothing is missing.
  bool check_given(process::Problems& problems, bool may_be_missing) const;
  // Reports several sources, and a video without its layout.
  void check_together(process::Problems& problems) const;

  // If there are no problems, exactly one member is set, or none if pictures may be missing.
  runs::PictureSource source() const;

 private:
  std::vector<std::string> sources_given() const;

  Option left_;
  Option right_;
  Option sequence_;
  Option video_;
  Option video_layout_;
  Option synthetic_;
};

// The options of `run`. Those that say what is simulated are options of `conflicts` too.
class RunOptions {
 public:
  // `more`: where the options that do not say what is simulated are added; null: nowhere. `beside_board`:
  // what BOARD may be beside a board.
  RunOptions(Options* of, Options* more, const std::string& beside_board = "");

  // Whether no option that says what is simulated is given but BOARD.
  bool has_board_only() const;
  // Reports problems of several options together, and then also those of the files of the board. `command`:
  // the name of the command.
  void check_together(const std::string& command, process::Problems& problems) const;

  // Loads and checks the inputs of the run. Throws Refused with all problems. Prints on standard error which
  // pictures were converted to grey. Checking pictures may take long. An interrupt during that time ends the
  // process, which has not changed anything yet. Afterwards interrupts are caught (catch_interrupts()).
  runs::RunInput load() const;

  bool is_fast() const { return fidelity.text() != "cycle"; }

  BoardOptions board;
  PictureOptions pictures;
  Option frames;
  SourceOption source;
  Option fidelity;
  Option timing_only;
  Option verify;
  TruthOptions truth;
  Option out;
  Option save_frames;
  Option record;
  TraceOptions trace;
  JsonOption json;
};

}  // namespace stereotlm::cli
