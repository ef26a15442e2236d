#pragma once

#include <functional>
#include <memory>
#include <string>

#include "sw/cli/commands.h"

namespace stereotlm::cli {

// Adds a command to the program. The parser calls `parsed` if the command line has this command. `footer`:
// the end of its help.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer = "");

// Adds a command with options, which add_to() adds and check_usage() checks. The action is `run` with them.
template <typename Options>
void add_command(CLI::App& program, Action& action, const std::string& name, const std::string& description,
                 int (*run)(const Options&), const std::string& footer = "") {
  const auto options = std::make_shared<Options>();
  const auto parsed = [options, run, &action] {
    options->check_usage();
    action = [options, run] { return run(*options); };
  };
  options->add_to(add_command(program, name, description, parsed, footer));
}

// Adds an option without a value. Parsing sets `is_given` if the command line has it.
void add_flag(CLI::App& command, const std::string& name, bool& is_given, const std::string& meaning);
// Replaces the end of the command's help.
void set_footer(CLI::App& command, const std::string& text);

}  // namespace stereotlm::cli
