#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sw/cli/board_options.h"
#include "sw/cli/picture_options.h"
#include "sw/cli/typed_option.h"
#include "sw/cli/unbuilt.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The options of `run`.
class RunOptions {
 public:
  // Adds them to the command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: throws Refused if they cannot be used.
  void check_usage();

  BoardOptions board;
  PictureOptions pictures;
  // As check_usage() leaves them.
  bool camera = true;  // else preloaded
  bool fast = true;    // else cycle by cycle
  bool timing_only = false;
  bool verify = false;
  std::optional<std::uint64_t> frames;
  std::optional<std::string> truth;
  double truth_scale = 1;
  bool save_frames = false;
  std::optional<std::string> out;

 private:
  void check_choices(process::Problems& problems);
  void check_numbers(process::Problems& problems);
  void check_combinations(process::Problems& problems) const;

  Typed frames_;
  Typed source_;
  Typed fidelity_;
  Typed truth_;
  Typed truth_scale_;
  Typed out_;
  UnbuiltOptions unbuilt_;
};

}  // namespace stereotlm::cli
