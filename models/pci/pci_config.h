#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/address_range.h"
#include "models/kernels/integer_rule.h"

namespace stereotlm::pci {

inline constexpr kernels::IntegerRule kLatencyTimerRule{0, 255};  // clocks
inline constexpr kernels::IntegerRule kWaitClocksRule{0, 255};    // clocks
inline constexpr kernels::IntegerRule kWidthRule{32, 64, 32};     // bits of the data bus
inline constexpr kernels::IntegerRule kMasterCountRule{1, 64};    // slots
inline constexpr kernels::IntegerRule kAddressRule{0, (std::int64_t{1} << 32) - 4, 4};  // bytes
inline constexpr kernels::IntegerRule kWindowBytesRule{4, std::int64_t{1} << 31, 4};    // bytes
inline constexpr kernels::IntegerRule kDmaBurstRule{1, 1024};                           // 32-bit words
inline constexpr kernels::IntegerRule kPostedWordsRule{1, 4096};                        // 32-bit words
inline constexpr kernels::IntegerRule kLoadBurstRule{1, 1024};                          // 32-bit words
inline constexpr kernels::IntegerRule kLoadTimeRule{0, 1'000'000'000'000'000};          // 1000 s
inline constexpr kernels::IntegerRule kLoadAccessRule{0, 1'000'000'000'000};            // 1 s

// A range of addresses that belongs to one target.
struct PciWindow {
  std::uint32_t base = 0;   // address of its first byte, kAddressRule
  std::uint32_t bytes = 4;  // size, kWindowBytesRule; the window ends within the 32-bit addresses
  int wait_clocks = 0;      // clocks between the address clock and the first word, kWaitClocksRule
};

// The configuration of a PciBus.
struct PciBusConfig {
  double clock_mhz = 33.333;         // 1..1000
  int latency_timer_clocks = 64;     // latency timer of every master, kLatencyTimerRule
  std::vector<std::string> masters;  // unique names for the statistics; kMasterCountRule
  std::vector<PciWindow> windows;    // without overlap
  int width_bits = 32;               // of the data bus, kWidthRule
};

// The configuration of a PciBridge.
struct PciBridgeConfig {
  int dma_burst_words =
      32;  // longest burst of a DMA channel and of posted writes on the local bus, kDmaBurstRule
  int posted_words = 64;  // places for words of posted writes, kPostedWordsRule
  // Byte address of the core's registers on the local bus, behind all banks.
  std::uint64_t core_registers = std::uint64_t{1} << 34U;
  std::vector<AddressRange> buffers = {};  // on the local bus; words for the banks are counted for each
  std::uint64_t row_bytes = 640;           // of a picture
};

// A master that loads the bus: it reads the same words again and again. Transfer k = 0, 1, .. requests the
// bus at first_request_ps + k * interval_ps, or at the end of transfer k - 1 if that is later. With
// interval_ps = 0 it requests the bus all the time. Its own device (TrafficGenerator::device) delays the
// first word by access_ps. During that time no other master gets the bus, because the latency timer cuts no
// wait clocks.
struct TrafficGeneratorConfig {
  std::uint32_t address = 0;           // address of the first word, kAddressRule
  int burst_words = 32;                // words of one transfer, kLoadBurstRule
  std::uint64_t first_request_ps = 0;  // time of the first request, kLoadTimeRule
  std::uint64_t interval_ps = 0;       // from one request to the next, kLoadTimeRule
  std::uint64_t access_ps = 0;         // access time of the device, kLoadAccessRule
};

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const PciBusConfig& config);
std::vector<std::string> problems(const PciBridgeConfig& config);
std::vector<std::string> problems(const TrafficGeneratorConfig& config);

}  // namespace stereotlm::pci
