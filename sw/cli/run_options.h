#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "sw/cli/board_options.h"
#include "sw/cli/unbuilt.h"

namespace stereotlm::cli {

// The options of `run`.
class RunOptions {
 public:
  // Adds them to the command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: throws Refused if they cannot be used.
  void check_usage();

  BoardOptions board;
  // As check_usage() leaves them.
  std::string left;
  std::string right;
  std::uint64_t frames = 1;
  std::optional<std::string> truth;
  double truth_scale = 1;
  std::optional<std::string> out;

 private:
  void check_pictures(Problems& problems) const;
  void check_choices(Problems& problems) const;
  void check_numbers(Problems& problems);

  // An option as it was typed.
  struct Typed {
    const CLI::Option* option = nullptr;
    std::string text;
    bool is_given() const { return option->count() > 0; }
  };
  static void add(CLI::App& command, Typed& typed, const std::string& name, const std::string& value,
                  const std::string& meaning);

  Typed left_;
  Typed right_;
  Typed frames_;
  Typed source_;
  Typed fidelity_;
  Typed truth_;
  Typed truth_scale_;
  Typed out_;
  UnbuiltOptions unbuilt_;
};

}  // namespace stereotlm::cli
