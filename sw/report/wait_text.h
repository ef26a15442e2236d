#pragma once

#include <string>

namespace stereotlm::report {

// Whom a port waits for: "left_pixel", "the turnaround". `by`: as in stats.json.
inline std::string cause_text(const std::string& by) { return by == "turnaround" ? "the turnaround" : by; }

// "left_lut on bank0 for left_pixel"
inline std::string wait_text(const std::string& port, const std::string& bank, const std::string& by) {
  return port + " on " + bank + " for " + cause_text(by);
}

}  // namespace stereotlm::report
