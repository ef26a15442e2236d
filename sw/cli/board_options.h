#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/cli/options.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {

// A board, and its tables from a calibration.
struct LoadedBoard {
  std::optional<platform::BoardConfig> board;         // nullopt if it has problems
  std::optional<runs::CalibrationInput> calibration;  // nullopt if none was given, or if it has problems

  // The following are only for a board without problems.
  platform::Tables tables() const { return runs::tables_of(*board, calibration); }
  runs::PointSimulator simulator() const {
    return calibration ? runs::PointSimulator(calibration->tables) : runs::PointSimulator();
  }
  // Prints a note if the board's clock is above that of the paper's core.
  void say_clock_remark() const;
};

// The argument BOARD and the options --set and --calibration, which all commands that take a board share.
struct BoardOptions {
  // Whether --set or --calibration is given.
  bool changes_board() const { return sets.is_given() || calibration.is_given(); }
  // BOARD and the options as typed, as words of a command line, without --set of an allocation.
  std::vector<std::string> words_without_allocation() const;
  // Loads the board and the calibration, and checks that they fit. Reports all problems.
  LoadedBoard load(process::Problems& problems) const;

  Options* of;
  std::string beside_board = "";  // what BOARD may be beside a board
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

}  // namespace stereotlm::cli
