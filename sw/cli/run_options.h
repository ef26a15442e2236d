#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sw/cli/board_options.h"
#include "sw/cli/json_option.h"
#include "sw/cli/picture_options.h"
#include "sw/cli/trace_options.h"
#include "sw/cli/truth_options.h"
#include "sw/cli/typed_option.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Parses and checks the options of `run`.
class RunOptions {
 public:
  // Adds the options to the command, before parsing.
  void add_to(CLI::App& command);
  // Adds only those that say what is simulated, for another command. `run`: what BOARD may be beside a board.
  void add_simulation_to(CLI::App& command, const std::string& beside_board = "");
  // Whether none of these but BOARD is given.
  bool has_board_only() const;

  // To be called in the command's callback: throws Refused if options are wrong.
  void check_usage();

  const char* command_name = "run";  // the command that has the options, for messages
  BoardOptions board;
  PictureOptions pictures;
  TruthOptions truth;
  TraceOptions trace;
  JsonOption json;
  // Set by check_usage().
  bool camera = true;  // false: preloaded
  bool fast = true;    // false: fidelity cycle
  bool timing_only = false;
  bool verify = false;
  std::optional<std::uint64_t> frames;
  bool save_frames = false;
  bool record = false;
  std::optional<std::string> out;

 private:
  void check_choices(process::Problems& problems);
  void check_numbers(process::Problems& problems);
  void check_combinations(process::Problems& problems) const;

  Typed frames_;
  Typed source_;
  Typed fidelity_;
  Typed out_;
};

}  // namespace stereotlm::cli
