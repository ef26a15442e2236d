#include "sw/cli/unbuilt.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

namespace stereotlm::cli {
namespace {

constexpr std::array kCommands = {"report"};

}  // namespace

void UnbuiltOption::add_to(CLI::App& command) {
  option_ = command.add_option(name_)->expected(0, 1)->take_all()->group("");
}

void UnbuiltOption::report(process::Problems& problems) const {
  if (option_ != nullptr && option_->count() > 0) problems.add(name_ + ": " + kNotInThisVersion);
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
