#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sw/process/problems.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stereotlm::cli {

// Options of contract section 5 that this version does not implement. The parser accepts them, so that the
// command can refuse them with kNotInThisVersion instead of as unknown options.
class UnbuiltOptions {
 public:
  // Adds an option with at most `values` values.
  void add(CLI::App& command, const std::string& name, int values);

  // The names of all these options, such as "--sequence, --video".
  std::string names() const;

  // Reports each of these options that was given.
  void report(process::Problems& problems) const;

 private:
  std::vector<std::pair<std::string, const CLI::Option*>> options_;
};

inline constexpr const char* kNotInThisVersion = "not in this version";

// The names of the commands of contract section 5 that this version does not implement, separated by commas.
std::string unbuilt_commands();
// Adds these commands to the program, hidden from its help. Each throws Refused with kNotInThisVersion.
void add_unbuilt_commands(CLI::App& program);
bool is_unbuilt(const CLI::App& command);

}  // namespace stereotlm::cli
