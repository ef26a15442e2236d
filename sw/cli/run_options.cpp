#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "sw/cli/add_command.h"
#include "sw/cli/text.h"

namespace stereotlm::cli {
namespace {

const std::vector<std::string> kSources = {"camera", "preloaded"};  // the first is the default
const std::vector<std::string> kFidelities = {"fast", "cycle"};

}  // namespace

void RunOptions::add_simulation_to(CLI::App& command, const std::string& beside_board) {
  board.add_to(command, beside_board);
  pictures.add_to(command);
  frames_.add_to(command, "--frames", "N",
                 "Frames to deliver, 1 or more; frame f of the cameras, or of the board if preloaded, shows "
                 "pair f modulo the "
                 "number of pairs (default 1; with --sequence and --video as many as there are pairs)");
  source_.add_to(
      command, "--source", fmt::format("{}", fmt::join(kSources, "|")),
      "camera (the default): cameras of a whole computer; preloaded: pictures appear in their buffers in no "
      "time");
  fidelity_.add_to(command, "--fidelity", fmt::format("{}", fmt::join(kFidelities, "|")),
                   "How the simulation works; the results are the same to the bit and to the "
                   "cycle: fast (the default), "
                   "or cycle by cycle, every access a transaction");
  add_flag(command, "--timing-only", timing_only,
           "Leave out all pixels: the times and counts are the same, and no picture is needed; writes no "
           "disparities");
}

bool RunOptions::has_board_only() const {
  return !board.changes_board() && !pictures.is_given() && !frames_.is_given() && !source_.is_given() &&
         !fidelity_.is_given() && !timing_only;
}

void RunOptions::add_to(CLI::App& command) {
  add_simulation_to(command);
  add_flag(command, "--verify", verify,
           "Run at the other fidelity too, in a second process, and compare every figure, time and pixel");
  truth.add_to(command, "the left picture that the last frame shows");
  out_.add_to(command, "--out", "DIR",
              "Folder for the result files: created if missing, else empty or an earlier result, which is "
              "replaced (default: no files)");
  add_flag(command, "--save-frames", save_frames,
           "Write the disparities of every frame too: frames/000000.png and so on in the folder of --out, "
           "numbered by camera frame");
  add_flag(command, "--record,--conflicts", record,
           "Write where and when ports wait: rows.csv and conflicts.csv in the folder of --out; with cameras "
           "also what happened when, and why it waited: timeline.csv and latency.csv");
  trace.add_to(command);
  json.add_to(command);
  set_footer(
      command,
      "Ctrl-C ends the run with the results of the frames that are finished; with cameras, --record or\n"
      "--trace those that the core has begun are finished first.");
}

void RunOptions::check_usage() {
  process::Problems problems;
  board.check_given(problems);
  pictures.check_given(problems, timing_only);
  const bool is_complete = problems.empty();
  pictures.check_usage(problems);
  check_choices(problems);
  check_numbers(problems);
  truth.check_usage(problems);
  trace.check_usage(problems);
  check_combinations(problems);
  if (!problems.empty() && board.is_given()) {  // all at once: those of its files too
    const auto loaded = board.load(problems);
    board.load_calibration(loaded ? &*loaded : nullptr, problems);
  }
  if (!is_complete)
    problems.add_note(fmt::format(
        "a complete command: stereotlm {} fpl2003 --left left.png --right right.png", command_name));
  problems.check();
  if (out_.is_given()) out = out_.text;
}

void RunOptions::check_choices(process::Problems& problems) {
  if (source_.is_given() && is_one_of(kSources, "--source", source_.text, problems)) {
    camera = source_.text == kSources.front();
  }
  if (fidelity_.is_given() && is_one_of(kFidelities, "--fidelity", fidelity_.text, problems)) {
    fast = fidelity_.text == kFidelities.front();
  }
}

void RunOptions::check_numbers(process::Problems& problems) {
  if (frames_.is_given()) {
    const auto number = number_of<std::uint64_t>(frames_.text);
    if (!number || *number == 0) {
      problems.add(fmt::format("--frames = {}: must be an integer, 1 or more", frames_.text));
    }
    frames = number;
  }
}

void RunOptions::check_combinations(process::Problems& problems) const {
  if (truth.file && pictures.source.synthetic) {
    problems.add("--truth: does not go with --synthetic, whose scene is its own truth");
  }
  for (const auto& [name, given] :
       {std::pair("--truth", truth.file.has_value()), std::pair("--save-frames", save_frames)}) {
    if (timing_only && given)
      problems.add(fmt::format("{}: does not go with --timing-only, which has no disparities", name));
  }
  if (record && !out_.is_given()) problems.add("--record: goes with --out DIR");
  if (save_frames && !out_.is_given()) problems.add("--save-frames: goes with --out DIR");
}

}  // namespace stereotlm::cli
