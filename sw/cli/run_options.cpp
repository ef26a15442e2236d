#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "platform/board_keys.h"
#include "sw/cli/text.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kExample =
    "stereotlm run fpl2003 --source preloaded --fidelity cycle --left left.png --right right.png";

// An option with a few values, of which this version has one; the default is not that one.
struct Choice {
  const char* name;
  std::vector<std::string> values;
  const char* usual;
  const char* built;
};

const Choice& source_choice() {
  static const Choice choice = {"--source", {"camera", "preloaded"}, "camera", "preloaded"};
  return choice;
}
const Choice& fidelity_choice() {
  static const Choice choice = {"--fidelity", {"cycle", "fast"}, "fast", "cycle"};
  return choice;
}

std::string unbuilt_value(const Choice& choice) { return fmt::format("{} {}", choice.name, choice.usual); }

void check_choice(const Choice& choice, bool is_given, const std::string& text, Problems& problems) {
  if (!is_given) {
    problems.add(fmt::format("{}, the default: {}; built: {} {}", unbuilt_value(choice), kNotInThisVersion,
                             choice.name, choice.built));
  } else if (is_one_of(choice.values, choice.name, text, problems) && text != choice.built) {
    problems.add(fmt::format("{} {}: {}; built: {} {}", choice.name, text, kNotInThisVersion, choice.name,
                             choice.built));
  }
}

}  // namespace

void RunOptions::add_to(CLI::App& command) {
  board.add_to(command);
  pictures.add_to(command);
  frames_.add_to(
      command, "--frames", "N",
      "Frames to deliver, 1 or more; frame f shows pair f modulo the number of pairs (default 1; with "
      "--sequence and --video as many as there are pairs)");
  source_.add_to(command, source_choice().name, fmt::format("{}", fmt::join(source_choice().values, "|")),
                 "Where pictures come from (default camera; this version has preloaded: they appear in their "
                 "buffers in no time)");
  fidelity_.add_to(
      command, fidelity_choice().name, fmt::format("{}", fmt::join(fidelity_choice().values, "|")),
      "How exact the timing is (default fast; this version has cycle: every bank and port, cycle by cycle)");
  truth_.add_to(command, "--truth", "F",
                "Ground truth of the left picture that the last frame shows, 8-bit grey, 0 = unknown");
  truth_scale_.add_to(command, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1)");
  out_.add_to(command, "--out", "DIR",
              "Folder for the result files: created if missing, else empty or an earlier result, which is "
              "replaced (default: no files)");
  command.add_flag(
      "--save-frames", save_frames,
      "Write the disparities of every frame too: frames/000000.png and so on in the folder of --out");
  unbuilt_.add(command, "--timing-only", 0);
  unbuilt_.add(command, "--verify", 0);
  unbuilt_.add(command, "--trace", 1);
  command.footer(
      paragraph("", 0,
                fmt::format("Not in this version: {}, {}; {}, {}.", unbuilt_.names(), board.unbuilt_names(),
                            unbuilt_value(source_choice()), unbuilt_value(fidelity_choice()))) +
      "Ctrl-C ends the run with the results of the frames that are finished.");
}

void RunOptions::check_usage() {
  Problems problems;
  board.check_built(problems);
  unbuilt_.report(problems);
  problems.check();  // what stands in for the pictures may be among them
  board.check_given(problems);
  pictures.check_given(problems);
  const bool is_complete = problems.empty();
  pictures.check_usage(problems);
  check_choices(problems);
  check_numbers(problems);
  check_combinations(problems);
  if (!is_complete) problems.add_note(std::string("a complete command: ") + kExample);
  problems.check();
  if (truth_.is_given()) truth = truth_.text;
  if (out_.is_given()) out = out_.text;
}

void RunOptions::check_choices(Problems& problems) const {
  check_choice(source_choice(), source_.is_given(), source_.text, problems);
  check_choice(fidelity_choice(), fidelity_.is_given(), fidelity_.text, problems);
}

void RunOptions::check_numbers(Problems& problems) {
  if (frames_.is_given()) {
    const auto number = number_of<std::uint64_t>(frames_.text);
    if (!number || *number == 0) {
      problems.add(fmt::format("--frames = {}: must be an integer, 1 or more", frames_.text));
    }
    frames = number;
  }
  if (truth_scale_.is_given()) {
    const auto number = number_of<double>(truth_scale_.text);
    if (!number || !std::isfinite(*number) || *number <= 0) {
      problems.add(fmt::format("--truth-scale = {}: must be a number above 0", truth_scale_.text));
    }
    truth_scale = number.value_or(1);
  }
}

void RunOptions::check_combinations(Problems& problems) const {
  if (truth_scale_.is_given() && !truth_.is_given()) problems.add("--truth-scale: goes with --truth F");
  if (truth_.is_given() && pictures.synthetic) {
    problems.add("--truth: does not go with --synthetic, whose scene is its own truth");
  }
  if (save_frames && !out_.is_given()) problems.add("--save-frames: goes with --out DIR");
}

}  // namespace stereotlm::cli
