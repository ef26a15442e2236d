#include "sw/cli/add_command.h"

#include <CLI/CLI.hpp>

namespace stereotlm::cli {

CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer) {
  CLI::App* command = program.add_subcommand(name, description);
  command->callback(parsed);
  command->footer(footer);
  return *command;
}

}  // namespace stereotlm::cli
