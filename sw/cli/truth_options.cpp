#include "sw/cli/truth_options.h"

#include <fmt/format.h>

#include <cmath>

namespace stereotlm::cli {

void TruthOptions::add_to(CLI::App& command, const std::string& picture) {
  file_.add_to(command, "--truth", "F", fmt::format("Ground truth of {}, 8-bit grey, 0 = unknown", picture));
  scale_.add_to(command, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1)");
}

void TruthOptions::check_usage(process::Problems& problems) {
  if (file_.is_given()) file = file_.text;
  if (!scale_.is_given()) return;
  const auto number = number_of<double>(scale_.text);
  if (!number || !std::isfinite(*number) || *number <= 0)
    problems.add(fmt::format("--truth-scale = {}: must be a number above 0", scale_.text));
  scale = number.value_or(1);
  if (!file_.is_given()) problems.add("--truth-scale: goes with --truth F");
}

}  // namespace stereotlm::cli
