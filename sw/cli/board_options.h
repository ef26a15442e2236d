#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/board_config.h"
#include "sw/cli/problems.h"
#include "sw/cli/unbuilt.h"

namespace stereotlm::cli {

// BOARD and the options that go with every command that takes one.
class BoardOptions {
 public:
  // Adds them to a command, before it is parsed.
  void add_to(CLI::App& command);

  // Options of every such command that are not in this version: "--calibration, .."
  std::string unbuilt_names() const { return unbuilt_.names(); }

  // While the command's callback runs: reports what is not in this version, and what is missing.
  void check_built(Problems& problems) const { unbuilt_.report(problems); }
  void check_given(Problems& problems) const;
  // Both; throws Refused.
  void check_usage() const;

  // BOARD as it was typed.
  const std::string& name() const { return board_; }

  // The board; nothing if it is wrong, with every reason reported.
  std::optional<platform::BoardConfig> load(Problems& problems) const;

 private:
  const CLI::Option* board_option_ = nullptr;
  std::string board_;
  std::vector<std::string> sets_;
  UnbuiltOptions unbuilt_;
};

}  // namespace stereotlm::cli
