#include "models/pci/pci_config.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::pci {
namespace {

constexpr std::uint64_t kAddressEnd = std::uint64_t{1} << 32U;

std::uint64_t end_of(const PciWindow& window) { return std::uint64_t{window.base} + window.bytes; }

void check_masters(const std::vector<std::string>& masters, std::vector<std::string>& found) {
  kMasterCountRule.check("masters", static_cast<std::int64_t>(masters.size()), found);
  for (auto master = masters.begin(); master != masters.end(); ++master) {
    if (master->empty() || std::find(masters.begin(), master, *master) != master) {
      found.push_back("masters = \"" + *master + "\": must be names, each once");
    }
  }
}

void check_windows(const std::vector<PciWindow>& windows, std::vector<std::string>& found) {
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const PciWindow& window = windows[i];
    const std::string name = "windows[" + std::to_string(i) + "]";
    kAddressRule.check(name + ".base", window.base, found);
    kWindowBytesRule.check(name + ".bytes", window.bytes, found);
    kWaitClocksRule.check(name + ".wait_clocks", window.wait_clocks, found);
    if (end_of(window) > kAddressEnd) {
      found.push_back(name + ".bytes = " + std::to_string(window.bytes) + ": must be at most " +
                      std::to_string(kAddressEnd - window.base) + " from its base on");
    }
    for (std::size_t other = 0; other < i; ++other) {
      if (window.base < end_of(windows[other]) && windows[other].base < end_of(window)) {
        found.push_back(name + ".base = " + std::to_string(window.base) + ": must not overlap windows[" +
                        std::to_string(other) + "]");
      }
    }
  }
}

}  // namespace

std::vector<std::string> problems(const PciBusConfig& config) {
  std::vector<std::string> found;
  if (!(config.clock_mhz >= 1 && config.clock_mhz <= 1000)) {
    found.push_back("clock_mhz = " + std::to_string(config.clock_mhz) + ": must be 1..1000");
  }
  kLatencyTimerRule.check("latency_timer_clocks", config.latency_timer_clocks, found);
  kWidthRule.check("width_bits", config.width_bits, found);
  check_masters(config.masters, found);
  check_windows(config.windows, found);
  return found;
}

std::vector<std::string> problems(const PciBridgeConfig& config) {
  std::vector<std::string> found;
  kDmaBurstRule.check("dma_burst_words", config.dma_burst_words, found);
  kPostedWordsRule.check("posted_words", config.posted_words, found);
  return found;
}

std::vector<std::string> problems(const TrafficGeneratorConfig& config) {
  std::vector<std::string> found;
  const auto as_signed = [](std::uint64_t value) { return static_cast<std::int64_t>(value); };
  kAddressRule.check("address", config.address, found);
  kLoadBurstRule.check("burst_words", config.burst_words, found);
  kLoadTimeRule.check("first_request_ps", as_signed(config.first_request_ps), found);
  kLoadTimeRule.check("interval_ps", as_signed(config.interval_ps), found);
  kLoadAccessRule.check("access_ps", as_signed(config.access_ps), found);
  if (kLoadBurstRule.allows(config.burst_words) &&
      config.address + 4 * static_cast<std::uint64_t>(config.burst_words) > kAddressEnd) {
    found.push_back("burst_words = " + std::to_string(config.burst_words) + ": must be at most " +
                    std::to_string((kAddressEnd - config.address) / 4) + " from its address on");
  }
  return found;
}

}  // namespace stereotlm::pci
