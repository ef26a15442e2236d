#pragma once

#include <string>

namespace stereotlm::report {

// "left_lut on bank0 for left_pixel", "left_pixel on bank4 for the turnaround". `by`: as in stats.json.
inline std::string wait_text(const std::string& port, const std::string& bank, const std::string& by) {
  return port + " on " + bank + " for " + (by == "turnaround" ? "the " : "") + by;
}

}  // namespace stereotlm::report
