#include "models/memory/memory_config.h"

#include <algorithm>

namespace stereotlm::memory {
namespace {

constexpr std::uint32_t kMostWords = 1U << 26U;

}  // namespace

std::vector<std::string> problems(const SsramBankConfig& config) {
  std::vector<std::string> found;
  if (config.words < 1 || config.words > kMostWords) {
    found.push_back("words = " + std::to_string(config.words) + ": must be 1..67108864");
  }
  const bool turns = config.kind == BankKind::kSyncBurst;
  if (turns ? config.turnaround_cycles < 1 || config.turnaround_cycles > 16 : config.turnaround_cycles != 0) {
    found.push_back("turnaround_cycles = " + std::to_string(config.turnaround_cycles) +
                    ": must be 1..16 with sync_burst, else 0");
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
