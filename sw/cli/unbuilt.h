#pragma once

#include <string>
#include <utility>

#include "sw/process/problems.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stereotlm::cli {

// An option of contract section 5 that this version does not implement. The parser accepts it, so that the
// command can refuse it with kNotInThisVersion instead of as an unknown option.
class UnbuiltOption {
 public:
  explicit UnbuiltOption(std::string name) : name_(std::move(name)) {}

  const std::string& name() const { return name_; }

  // Adds the option, with at most one value.
  void add_to(CLI::App& command);

  // Reports the option if it was given.
  void report(process::Problems& problems) const;

 private:
  std::string name_;
  const CLI::Option* option_ = nullptr;
};

inline constexpr const char* kNotInThisVersion = "not in this version";

}  // namespace stereotlm::cli
