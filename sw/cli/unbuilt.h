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

// Options and commands of contract section 5 that this version does not have. They get a message of their own
// instead of one about an unknown option.
class UnbuiltOptions {
 public:
  // Adds an option with at most `values` values.
  void add(CLI::App& command, const std::string& name, int values);

  // "--sequence, --video, .."
  std::string names() const;

  // Reports each of these options that was given.
  void report(process::Problems& problems) const;

 private:
  std::vector<std::pair<std::string, const CLI::Option*>> options_;
};

inline constexpr const char* kNotInThisVersion = "not in this version";

// "calibrate, explain, .."
std::string unbuilt_commands();
void add_unbuilt_commands(CLI::App& program);
bool is_unbuilt(const CLI::App& command);

}  // namespace stereotlm::cli
