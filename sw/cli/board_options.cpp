#include "sw/cli/board_options.h"

#include <string_view>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {

void BoardOptions::add_to(CLI::App& command, const std::string& beside_board) {
  board_.add_to(command, "BOARD", " ",
                "A preset (see stereotlm boards), or the path of a board file: has a / or ends in .yaml" +
                    beside_board);
  sets_.add_to(command, "--set", "KEY=VALUE",
               "Give a key of the board another value, a YAML flow value; again for further keys "
               "(see stereotlm keys)");
  sets_.takes_one_at_a_time();
  calibration_option_.add_to(
      command, "--calibration", "F",
      "Tables from the calibration of a rig, as written by stereotlm calibrate, in place of the "
      "identity");
}

void BoardOptions::check_given(process::Problems& problems) {
  if (calibration_option_.is_given()) calibration_ = calibration_option_.text;
  if (!board_.is_given()) problems.add("BOARD: missing: a preset or the path of a board file");
}

void BoardOptions::check_usage() {
  process::Problems problems;
  check_given(problems);
  problems.check();
}

std::vector<std::string> BoardOptions::words_without_allocation() const {
  constexpr std::string_view kSection = "allocation";
  std::vector<std::string> words = {board_.text};
  if (calibration_) words.insert(words.end(), {"--calibration", *calibration_});
  for (const std::string& set : sets_.text) {
    if (set.substr(0, set.find_first_of(".=")) != kSection) words.insert(words.end(), {"--set", set});
  }
  return words;
}

std::optional<platform::BoardConfig> BoardOptions::load(process::Problems& problems) const {
  try {
    return platform::load_board(board_.text, sets_.text);
  } catch (const platform::BoardError& error) {
    problems.add(error);
    return std::nullopt;
  }
}

std::optional<runs::CalibrationInput> BoardOptions::load_calibration(const platform::BoardConfig* board,
                                                                     process::Problems& problems) const {
  if (!calibration_) return std::nullopt;
  return runs::load_calibration(*calibration_, board, problems);
}

void say_clock_remark(const platform::BoardConfig& board) {
  const std::string remark = platform::clock_remark(board);
  if (!remark.empty()) process::say("note", remark);
}

}  // namespace stereotlm::cli
