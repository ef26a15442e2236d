#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
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
  } else if (std::find(choice.values.begin(), choice.values.end(), text) == choice.values.end()) {
    problems.add(fmt::format("{} = {}: must be {}", choice.name, text, platform::listed(choice.values)));
  } else if (text != choice.built) {
    problems.add(fmt::format("{} {}: {}; built: {} {}", choice.name, text, kNotInThisVersion, choice.name,
                             choice.built));
  }
}

// The whole text as a number.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

void RunOptions::add(CLI::App& command, Typed& typed, const std::string& name, const std::string& value,
                     const std::string& meaning) {
  typed.option = command.add_option(name, typed.text, meaning)->option_text(value);
}

void RunOptions::add_to(CLI::App& command) {
  board.add_to(command);
  add(command, left_, "--left", "F", "The left picture of the pair, 8-bit, as large as the board's images");
  add(command, right_, "--right", "F", "The right picture");
  add(command, frames_, "--frames", "N", "Frames to deliver, 1 or more, each of the same pair (default 1)");
  add(command, source_, source_choice().name, fmt::format("{}", fmt::join(source_choice().values, "|")),
      "Where pictures come from (default camera; this version has preloaded: they appear in their buffers "
      "in no time)");
  add(command, fidelity_, fidelity_choice().name, fmt::format("{}", fmt::join(fidelity_choice().values, "|")),
      "How exact the timing is (default fast; this version has cycle: every bank and port, cycle by cycle)");
  add(command, truth_, "--truth", "F", "Ground truth of the left picture, 8-bit grey, 0 = unknown");
  add(command, truth_scale_, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1)");
  add(command, out_, "--out", "DIR",
      "Folder for the result files: created if missing, else empty or an earlier result, which is replaced "
      "(default: no files)");
  unbuilt_.add(command, "--sequence", 1);
  unbuilt_.add(command, "--video", 2);
  unbuilt_.add(command, "--video-layout", 1);
  unbuilt_.add(command, "--synthetic", 1);
  unbuilt_.add(command, "--timing-only", 0);
  unbuilt_.add(command, "--verify", 0);
  unbuilt_.add(command, "--trace", 1);
  unbuilt_.add(command, "--save-frames", 0);
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
  check_pictures(problems);
  const bool is_complete = problems.empty();
  check_choices(problems);
  check_numbers(problems);
  if (!is_complete) problems.add_note(std::string("a complete command: ") + kExample);
  problems.check();
  left = left_.text;
  right = right_.text;
  if (truth_.is_given()) truth = truth_.text;
  if (out_.is_given()) out = out_.text;
}

void RunOptions::check_choices(Problems& problems) const {
  check_choice(source_choice(), source_.is_given(), source_.text, problems);
  check_choice(fidelity_choice(), fidelity_.is_given(), fidelity_.text, problems);
}

void RunOptions::check_pictures(Problems& problems) const {
  if (!left_.is_given()) problems.add("--left: missing: a run needs --left F and --right F");
  if (!right_.is_given()) problems.add("--right: missing: a run needs --left F and --right F");
}

void RunOptions::check_numbers(Problems& problems) {
  if (frames_.is_given()) {
    const auto number = number_of<std::uint64_t>(frames_.text);
    if (!number || *number == 0) {
      problems.add(fmt::format("--frames = {}: must be an integer, 1 or more", frames_.text));
    }
    frames = number.value_or(1);
  }
  if (truth_scale_.is_given()) {
    const auto number = number_of<double>(truth_scale_.text);
    if (!number || !std::isfinite(*number) || *number <= 0) {
      problems.add(fmt::format("--truth-scale = {}: must be a number above 0", truth_scale_.text));
    }
    truth_scale = number.value_or(1);
    if (!truth_.is_given()) problems.add("--truth-scale: goes with --truth F");
  }
}

}  // namespace stereotlm::cli
