#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::pci {

inline constexpr kernels::IntegerRule kLatencyTimerRule{0, 255};
inline constexpr kernels::IntegerRule kWaitClocksRule{0, 255};
inline constexpr kernels::IntegerRule kMasterCountRule{1, 64};
inline constexpr kernels::IntegerRule kAddressRule{0, (std::int64_t{1} << 32) - 4, 4};
inline constexpr kernels::IntegerRule kWindowBytesRule{4, std::int64_t{1} << 31, 4};
inline constexpr kernels::IntegerRule kLoadBurstRule{1, 1024};
inline constexpr kernels::IntegerRule kLoadTimeRule{0, 1'000'000'000'000'000};  // 1000 s
inline constexpr kernels::IntegerRule kLoadAccessRule{0, 1'000'000'000'000};    // 1 s

// A range of addresses that one target answers.
struct PciWindow {
  std::uint32_t base = 0;   // of its first byte, kAddressRule
  std::uint32_t bytes = 4;  // kWindowBytesRule; no further than the end of the 32-bit addresses
  int wait_clocks = 0;      // from the address clock to the first word, kWaitClocksRule
};

struct PciBusConfig {
  double clock_mhz = 33.333;         // 1..1000
  int latency_timer_clocks = 64;     // of every master, kLatencyTimerRule
  std::vector<std::string> masters;  // their names in the statistics, each once; kMasterCountRule
  std::vector<PciWindow> windows;    // must not overlap
};

// A third party on the bus, which reads the same words again and again. The k-th transfer (from 0) asks for
// the bus at first_request_ps + k * interval_ps, or when the one before it has ended, if that is later:
// interval_ps = 0 is a hog. access_ps is the time that its own device (TrafficGenerator::device) makes the
// bus wait for the first word: what keeps every other master off the bus, as the latency timer cuts no wait
// clocks.
struct PciLoadConfig {
  std::uint32_t address = 0;           // of the first word, kAddressRule
  int burst_words = 32;                // of one transfer, kLoadBurstRule
  std::uint64_t first_request_ps = 0;  // kLoadTimeRule
  std::uint64_t interval_ps = 0;       // kLoadTimeRule
  std::uint64_t access_ps = 0;         // kLoadAccessRule
};

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const PciBusConfig& config);
std::vector<std::string> problems(const PciLoadConfig& config);

}  // namespace stereotlm::pci
