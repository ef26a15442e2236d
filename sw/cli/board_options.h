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

// BOARD and the options that go with every command that takes one.
class BoardOptions {
 public:
  // Adds them to a command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: reports what is missing; or throws Refused.
  void check_given(process::Problems& problems);
  void check_usage();

  // BOARD as it was typed.
  const std::string& name() const { return board_.text; }

  // The board; nothing if it is wrong, with every reason reported.
  std::optional<platform::BoardConfig> load(process::Problems& problems) const;

  // The calibration that was given, if any, as checked, for that board; nothing if it is wrong too, with
  // every reason reported. `board`: null if it is wrong.
  std::optional<runs::CalibrationInput> load_calibration(const platform::BoardConfig* board,
                                                         process::Problems& problems) const;

 private:
  Typed board_;
  TypedList sets_;
  Typed calibration_option_;
  std::optional<std::string> calibration_;  // as check_given() leaves it
};

}  // namespace stereotlm::cli
