#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/cli/options.h"
#include "sw/explore/plan/plan.h"
#include "sw/process/client.h"
#include "sw/process/problems.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_results.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/open_source.h"
#include "sw/trace/trace.h"

namespace stereotlm::cli {

// A board, and its tables from a calibration.
struct LoadedBoard {
  std::optional<platform::BoardConfig> board;         // nullopt if it has problems
  std::optional<runs::CalibrationInput> calibration;  // nullopt if none was given, or if it has problems
  std::string file_text;                              // what the board file holds; empty for a preset

  // The following are only for a board without problems.
  platform::Tables tables() const { return runs::tables_of(*board, calibration); }
  runs::PointSimulator simulator() const {
    return calibration ? runs::PointSimulator(calibration->tables) : runs::PointSimulator();
  }
  // Prints a note if the board's clock is above that of the paper's core.
  void say_clock_remark() const;
};

// Refuses so many worker processes if the limit on open files is too low for them. `jobs`: as asked for.
void check_jobs(std::uint64_t jobs, std::uint64_t workers);

// Why --banks is too large for a board with so many banks.
std::string most_banks_text(int asked, std::size_t banks);

// What the client has sent as the content of the file `name`; null if `path` is to be read. Throws
// std::runtime_error if a client names a pipe or a device there, on which it cannot write while it waits for
// the answer. On the command line both can be read.
const std::string* sent_content(const process::FileContents& sent, const std::string& name,
                                const std::string& path);

// The argument BOARD and the options --set and --calibration, which all commands that take a board share.
struct BoardOptions {
  // Whether --set or --calibration is given.
  bool changes_board() const { return sets.is_given() || calibration.is_given(); }
  // BOARD and the options as typed, as words of a command line, without --set of an allocation.
  std::vector<std::string> words_without_allocation() const;
  // Loads the board and the calibration, and checks that they fit. Reports all problems. A command that needs
  // no BOARD gets fpl2003.
  LoadedBoard load(process::Problems& problems) const;

  Options* of;
  std::string beside_board = "";  // what BOARD may be beside a board
  process::FileContents sent = process::sent_files();
  Option argument = Option(
      of, "BOARD", " ",
      "A preset (see stereotlm boards), or the path of a board file: has a / or ends in .yaml" + beside_board,
      {required("a preset or the path of a board file")});
  Option sets = Option(of, "--set", "KEY=VALUE",
                       "Give a key of the board another value, a YAML flow value; again for further keys "
                       "(see stereotlm keys)",
                       {}, Takes::kRepeated);
  Option calibration = Option(
      of, "--calibration", "F",
      "Tables from the calibration of a rig, as written by stereotlm calibrate, in place of the identity");
};

// Loads the calibration that `option` or the plan names, and gives its tables to the plan. Returns nullopt if
// neither names one. Throws Refused if the calibration cannot be loaded or fits no point.
std::optional<runs::CalibrationInput> calibration_of(explore::Plan& plan, const Option& option,
                                                     const process::FileContents& sent);

// The options of a command that takes nothing but a board.
struct BoardCommandOptions : Options {
  using Options::Options;

  BoardOptions board{this};
  JsonOption json{this};
};

// Groups of options. `of`: the options of which they are a part; null: they are never given.

struct TraceOptions {
  // Reports a trace that is none, or whose files another trace writes too, and a vcd without a window.
  void check_together(process::Problems& problems) const;
  // Reports a window outside the images of the board, or after the last of `frames` frames.
  void check_window(const platform::BoardConfig& board, std::uint64_t frames,
                    process::Problems& problems) const;
  // The traces, without those that are none.
  std::vector<trace::TraceFile> traces() const;
  // nullopt if there is no window.
  std::optional<trace::TraceWindow> window() const;

  static std::string meaning();
  static void is_window(const Option& option, process::Problems& problems);

  Options* of;
  Option files = Option(of, "--trace", "FORMAT:FILE", meaning(), {}, Takes::kRepeated);
  Option window_text =
      Option(of, "--trace-window", "WINDOW",
             "Trace each cycle of a part of the run: frame=F[,rows=A..B | ,cycles=A..B] or cycles=A..B, the "
             "limits included; frames and rows count from 0, cycles from the frame's first or from power-up; "
             "with ,longest-wait only the cycles around the longest wait in it; vcd needs a window",
             {is_window, goes_with(files, "FORMAT:FILE")});
};

struct TruthOptions {
  // Levels of the truth per disparity.
  std::optional<double> scale() const { return scale_text.number<double>(); }

  Options* of;
  std::string picture;  // whose truth it is, for the help
  process::FileContents sent = process::sent_files({runs::kKeptTruth});
  Option file = Option(of, "--truth", "F",
                       "Ground truth of " + picture + ": grey of 8 or 16 bits, 0 = unknown, or PFM");
  Option scale_text = Option(
      of, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1; 256 of KITTI)",
      {number<double>("a number above 0", [](double scale) { return std::isfinite(scale) && scale > 0; }),
       goes_with(file, "F")});
};

// Reports a video without layout, and a layout of another number of files.
void check_video(const Option& video, const Option& layout, process::Problems& problems);

// The options that select the pictures of a run.
struct PictureOptions {
  bool is_given() const { return !sources_given().empty() || video_layout.is_given(); }
  // Reports a missing source of pictures (unless `may_be_missing`), several sources, a pair with one side,
  // and a video without its layout. Returns whether nothing is missing.
  bool check_together(process::Problems& problems, bool may_be_missing) const;
  // The source as named: if there are no problems, exactly one, or none if pictures may be missing.
  runs::InputPictures named() const;
  std::vector<std::string> sources_given() const;

  Options* of;
  Option left = Option(of, "--left", "F",
                       "The left picture, or a quoted pattern of several ('left/*.png'), shown in natural "
                       "order (2 before 10); 8-bit, as large as the board's images");
  Option right = Option(of, "--right", "F", "The right picture, or as many, in the same order");
  Option sequence = Option(of, "--sequence", "DIR",
                           "A folder of pairs left_*.png and right_*.png, shown in the order of their names");
  Option video = Option(of, "--video", "F [F2]", "A video of pairs, or two videos, the left one first", {},
                        Takes::kOneOrTwo);
  Option video_layout =
      Option(of, "--video-layout", "LAYOUT",
             "Where --video has the pictures of a pair: two (files), side_by_side or top_bottom (in one "
             "file, the left one in the left or upper half of each frame)",
             {goes_with(video, "F [F2]"), one_of(runs::kVideoLayoutNames)});
  Option synthetic =
      Option(of, "--synthetic", "SEED",
             "A synthetic moving scene with known disparities; another one for each SEED, 0 or more",
             {number<std::uint64_t>(kSeedRule)});
  Option fit =
      Option(of, "--fit", "crop|pad",
             "Take pictures of another size than the board's images: crop takes the middle of larger "
             "ones, pad repeats the last column and row of smaller ones; truth alike",
             {one_of(media::kFitNames)});
};

// The options of `run`. Those that say what is simulated are options of `conflicts` too, and those of the
// board and its pictures are options of `rtl`.
struct RunOptions {
  // Whether no option that says what is simulated is given but BOARD.
  bool has_board_only() const;
  // Reports problems of several options together, and then also those of the files of the board. `command`:
  // the name of the command.
  void check_together(const std::string& command, process::Problems& problems) const;

  // Loads and checks the inputs of the run. Throws Refused with all problems. Prints on standard error which
  // pictures were converted to grey. Checking pictures may take long. An interrupt during that time ends the
  // process, which has not changed anything yet. Afterwards interrupts are caught (catch_interrupts()).
  runs::RunInput load() const;

  // Of --disparity-offset, in columns; nullopt if it is not given.
  std::optional<int> offset() const { return disparity_offset.number<int>(); }

  // The first frames whose waits are recorded; 0: none.
  std::uint64_t recorded_frames() const;

  Options* of;
  Options* mode;                  // of the options that say how often, with what around it, and how
  Options* more;                  // of the options that do not say what is simulated
  std::string beside_board = "";  // what BOARD may be beside a board
  BoardOptions board{of, beside_board};
  PictureOptions pictures{of};
  Option disparity_offset =
      Option(of, "--disparity-offset", "N",
             "Columns that the left table subtracts from every disparity of rectified pairs, also below 0: "
             "disparities N .. N+D-1 are found, and truth is that of the left picture as it is",
             {number<int>("an integer, -8191..8191",
                          [](int columns) { return columns > -8192 && columns < 8192; })});
  Option frames = Option(
      mode, "--frames", "N",
      "Frames to deliver, 1 or more; frame f of the cameras, or of the board if preloaded, shows pair f "
      "modulo "
      "the number of pairs (default: as many as there are pairs, 1 with --synthetic)",
      {number<std::uint64_t>("an integer, 1 or more", [](std::uint64_t count) { return count > 0; })});
  SourceOption source{
      mode,
      "camera (the default): cameras of a whole computer; preloaded: pictures appear in their buffers in no "
      "time"};
  Option fidelity =
      Option(mode, "--fidelity", "fast|cycle",
             "How the simulation works; the results are the same to the bit and to the cycle: fast (the "
             "default), or cycle by cycle, every access a transaction",
             {one_of({"fast", "cycle"})});
  Option timing_only =
      Option(mode, "--timing-only", "",
             "Leave out all pixels: the times and counts are the same, and no picture is needed; writes no "
             "disparities");
  Option verify =
      Option(more, "--verify", "",
             "Run at the other fidelity too, in a second process, and compare every figure, time and pixel");
  TruthOptions truth{more, "the left picture that the last frame shows"};
  Option out =
      Option(more, "--out", "DIR",
             "Folder for the result files: created if missing, else empty or an earlier result, which is "
             "replaced (default: no files)");
  Option save_frames =
      Option(more, "--save-frames", "",
             "Write the disparities of every frame too: frames/000000.png and so on in the folder of --out, "
             "numbered by camera frame",
             process::client == nullptr ? std::vector<Rule>{goes_with(out, "DIR")} : std::vector<Rule>{});
  Option record = Option(
      more, "--record,--conflicts", "",
      "Record in the folder of --out where and when ports wait, and with cameras what happened when, in all "
      "frames (default: in the first " +
          std::to_string(runs::kRecordedFrames) + ")",
      {goes_with(out, "DIR")});
  Option no_record = Option(more, "--no-record", "", "Record nothing: quicker for long runs without pixels");
  TraceOptions trace{more};
  JsonOption json{more};
  Option page_data = Option(more, "--page-data", "",
                            "Print the data of the page that `report` would write of this run, as JSON");
};

}  // namespace stereotlm::cli
