#pragma once

#include <optional>
#include <string>

#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The options --truth and --truth-scale.
class TruthOptions {
 public:
  // Adds the options to a command, before parsing. `picture`: the picture whose truth it is, for the help.
  void add_to(CLI::App& command, const std::string& picture);
  // To be called in the command's callback: reports problems.
  void check_usage(process::Problems& problems);

  // Set by check_usage().
  std::optional<std::string> file;
  double scale = 1;  // grey levels per disparity

 private:
  Typed file_;
  Typed scale_;
};

}  // namespace stereotlm::cli
