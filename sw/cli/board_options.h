#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"
#include "sw/runs/sources/calibration_input.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The argument BOARD and the options --set and --calibration, which all commands that take a board share.
class BoardOptions {
 public:
  // Adds the options to a command, before parsing. `beside_board`: what BOARD may be beside a board.
  void add_to(CLI::App& command, const std::string& beside_board = "");

  // To be called in the command's callback: reports a missing BOARD.
  void check_given(process::Problems& problems);
  // To be called in the command's callback: throws Refused if BOARD is missing.
  void check_usage();

  // Whether --set or --calibration is given.
  bool changes_board() const { return sets_.is_given() || calibration_option_.is_given(); }
  bool is_given() const { return board_.is_given(); }
  // BOARD as typed.
  const std::string& name() const { return board_.text; }

  // BOARD and the options as typed, as words of a command line, without --set of an allocation.
  std::vector<std::string> words_without_allocation() const;

  // Loads the board. Reports all problems and returns nullopt if there are any.
  std::optional<platform::BoardConfig> load(process::Problems& problems) const;

  // Loads the calibration and checks that it fits the board. Returns nullopt if none was given, or if there
  // are problems, which it reports. `board`: null if the board has problems; the fit is then not checked.
  std::optional<runs::CalibrationInput> load_calibration(const platform::BoardConfig* board,
                                                         process::Problems& problems) const;

 private:
  Typed board_;
  TypedList sets_;
  Typed calibration_option_;
  std::optional<std::string> calibration_;  // set by check_given()
};

// Prints a note if the board's clock is above that of the paper's core.
void say_clock_remark(const platform::BoardConfig& board);

}  // namespace stereotlm::cli
