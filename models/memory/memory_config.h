#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"
#include "models/memory/bank_traits.h"
#include "models/memory/sdram.h"

namespace stereotlm::memory {

inline constexpr kernels::IntegerRule kBankWordsRule{1, std::int64_t{1} << 26};  // 32-bit words of a bank
inline constexpr kernels::IntegerRule kBankCountRule{1, 64};                     // banks of a crossbar

// A byte address on the crossbar: bits 28 and up are the bank, the lower bits the byte in that bank.
inline constexpr unsigned kBankAddressBits = 28;
constexpr std::uint64_t crossbar_address(std::uint64_t bank, std::uint64_t word) {
  return bank << kBankAddressBits | word << 2U;
}
constexpr std::uint64_t address_in_bank(std::uint64_t address) {  // the byte in its bank
  return address & ((std::uint64_t{1} << kBankAddressBits) - 1);
}
// The bank of an address.
constexpr std::uint64_t bank_of_address(std::uint64_t address) { return address >> kBankAddressBits; }

// The index of a port on the banks: 0 .. n-1. The module that owns the ports names them (fpga/core_ports.h).
using Port = std::size_t;
// The largest number of ports.
inline constexpr std::size_t kMostPorts = 66;

// A set of ports: bit number `port` is 1 if the port is in the set.
__extension__ using PortMask = unsigned __int128;
static_assert(kMostPorts <= 128);
constexpr PortMask mask_of(Port port) { return PortMask{1} << port; }
constexpr bool has(PortMask ports, Port port) {
  const auto half = static_cast<std::uint64_t>(port < 64 ? ports : ports >> 64U);
  return (half >> port % 64 & 1U) != 0;
}
// The port with the lowest index in a set that is not empty.
constexpr Port lowest_port(PortMask ports) {
  const auto low = static_cast<std::uint64_t>(ports);
  return static_cast<Port>(low != 0 ? __builtin_ctzll(low)
                                    : 64 + __builtin_ctzll(static_cast<std::uint64_t>(ports >> 64U)));
}
// Calls visit(port) for each port of a set, the lowest first.
template <class Visit>
void for_each_port(PortMask ports, const Visit& visit) {
  for (auto low = static_cast<std::uint64_t>(ports); low != 0; low &= low - 1)
    visit(static_cast<Port>(__builtin_ctzll(low)));
  for (auto high = static_cast<std::uint64_t>(ports >> 64U); high != 0; high &= high - 1)
    visit(static_cast<Port>(64 + __builtin_ctzll(high)));
}

using PriorityList = std::vector<Port>;  // the first port comes first

// The configuration of the arbiter of a bank.
struct ArbiterConfig {
  std::string policy = "fixed_priority";  // a name of arbitration_policies()
  PriorityList priority;                  // all ports, each once; the policy says what the order means
};

// A bank: SSRAM, or SDRAM in its place.
struct SsramBankConfig {
  std::uint32_t words = 524288;                     // 32-bit words, kBankWordsRule
  BankKind kind = BankKind::kZbtPipelined;          // kBankTraits has its properties
  int turnaround_cycles = 0;                        // kTurnaroundRule if the kind has turnaround, else 0
  double clock_mhz = 40;                            // clock of the bank, 1..1000
  std::optional<SdramTiming> sdram = std::nullopt;  // of this kind only, which needs it
};

// From the grant of a read to the cycle in which its reader can use the word.
inline int read_latency_cycles(const SsramBankConfig& bank) {
  return bank.sdram ? bank.sdram->cas_latency : traits_of(bank.kind).read_latency_cycles;
}

// Returns the rule that `turnaround_cycles` breaks for a bank of this kind, such as "1..16 for sync_burst";
// empty if the value is allowed.
std::string broken_turnaround_rule(BankKind kind, int turnaround_cycles);

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const SsramBankConfig& config);
std::vector<std::string> problems(const ArbiterConfig& config);

}  // namespace stereotlm::memory
