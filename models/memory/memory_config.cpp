#include "models/memory/memory_config.h"

#include <algorithm>

namespace stereotlm::memory {

std::vector<std::string> problems(const SsramBankConfig& config) {
  std::vector<std::string> found;
  kBankWordsRule.check("words", config.words, found);
  const bool turns = config.kind == BankKind::kSyncBurst;
  if (turns ? !kTurnaroundRule.allows(config.turnaround_cycles) : config.turnaround_cycles != 0) {
    found.push_back("turnaround_cycles = " + std::to_string(config.turnaround_cycles) + ": must be " +
                    kTurnaroundRule.text() + " with sync_burst, else 0");
  }
  if (!(config.clock_mhz >= 1 && config.clock_mhz <= 1000)) {
    found.push_back("clock_mhz = " + std::to_string(config.clock_mhz) + ": must be 1..1000");
  }
  return found;
}

std::vector<std::string> problems(const ArbiterConfig& config) {
  std::vector<std::string> found;
  for (std::size_t port = 0; port < kPortCount; ++port) {
    const auto times = std::count(config.priority.begin(), config.priority.end(), static_cast<Port>(port));
    if (times != 1) {
      found.push_back(std::string("priority = ") + kPortNames[port] + " " + std::to_string(times) +
                      " times: must name each port once");
    }
  }
  return found;
}

}  // namespace stereotlm::memory
