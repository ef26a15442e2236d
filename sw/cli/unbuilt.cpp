#include "sw/cli/unbuilt.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

namespace stereotlm::cli {
namespace {

constexpr std::array kCommands = {"report"};

}  // namespace

void UnbuiltOptions::add(CLI::App& command, const std::string& name, int values) {
  CLI::Option* option = values == 0 ? command.add_flag(name) : command.add_option(name)->expected(0, values);
  options_.emplace_back(name, option->take_all()->group(""));
}

std::string UnbuiltOptions::names() const {
  std::string names;
  for (const auto& [name, option] : options_) names += (names.empty() ? "" : ", ") + name;
  return names;
}

void UnbuiltOptions::report(process::Problems& problems) const {
  for (const auto& [name, option] : options_) {
    if (option->count() > 0) problems.add(name + ": " + kNotInThisVersion);
  }
}

std::string unbuilt_commands() {
  std::string names;
  for (const char* name : kCommands) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

bool is_unbuilt(const CLI::App& command) {
  return std::find(kCommands.begin(), kCommands.end(), command.get_name()) != kCommands.end();
}

void add_unbuilt_commands(CLI::App& program) {
  for (const char* name : kCommands) {
    CLI::App* command = program.add_subcommand(name)->group("")->prefix_command();
    command->set_help_flag();
    command->preparse_callback(
        [name](std::size_t /*arguments*/) { process::refuse(std::string(name) + ": " + kNotInThisVersion); });
  }
}

}  // namespace stereotlm::cli
