#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"
#include "models/memory/bank_traits.h"

namespace stereotlm::memory {

inline constexpr kernels::IntegerRule kBankWordsRule{1, std::int64_t{1} << 26};
inline constexpr kernels::IntegerRule kBankCountRule{1, 64};

// The six ports of the FPGA on the SSRAM banks, in the order in which results list them.
enum class Port : std::uint8_t { kLeftLut, kRightLut, kLeftPixel, kRightPixel, kResult, kHost };
inline constexpr std::size_t kPortCount = 6;
inline constexpr std::array<const char*, kPortCount> kPortNames = {"left_lut",    "right_lut", "left_pixel",
                                                                   "right_pixel", "result",    "host"};
constexpr std::size_t index_of(Port port) { return static_cast<std::size_t>(port); }
constexpr const char* name_of(Port port) { return kPortNames[index_of(port)]; }

// A set of ports: bit index_of(port) for each.
using PortMask = std::uint8_t;
constexpr PortMask mask_of(Port port) { return static_cast<PortMask>(1U << index_of(port)); }

using PriorityList = std::array<Port, kPortCount>;

struct ArbiterConfig {
  std::string policy = "fixed_priority";  // a name of arbitration_policies()
  // Each port once; the policy says what the order means.
  PriorityList priority = {Port::kHost,       Port::kResult,  Port::kLeftPixel,
                           Port::kRightPixel, Port::kLeftLut, Port::kRightLut};
};

struct SsramBankConfig {
  std::uint32_t words = 524288;  // 32-bit words, kBankWordsRule
  BankKind kind = BankKind::kZbtPipelined;
  int turnaround_cycles = 0;  // kTurnaroundRule if the kind has turnaround, else 0
  double clock_mhz = 40;      // of the bank's only clock, 1..1000
};

// The rule that breaks a bank of this kind with these turnaround cycles: "1..16 for sync_burst"; empty if it
// keeps its rule.
std::string broken_turnaround_rule(BankKind kind, int turnaround_cycles);

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const SsramBankConfig& config);
std::vector<std::string> problems(const ArbiterConfig& config);

}  // namespace stereotlm::memory
