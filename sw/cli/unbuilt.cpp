#include "sw/cli/unbuilt.h"

#include <CLI/CLI.hpp>

namespace stereotlm::cli {

void UnbuiltOption::add_to(CLI::App& command) {
  option_ = command.add_option(name_)->expected(0, 1)->take_all()->group("");
}

void UnbuiltOption::report(process::Problems& problems) const {
  if (option_ != nullptr && option_->count() > 0) problems.add(name_ + ": " + kNotInThisVersion);
}

}  // namespace stereotlm::cli
