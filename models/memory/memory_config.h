#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::memory {

inline constexpr kernels::IntegerRule kBankWordsRule{1, std::int64_t{1} << 26};
inline constexpr kernels::IntegerRule kTurnaroundRule{1, 16};
inline constexpr kernels::IntegerRule kBankCountRule{1, 64};

// The six ports of the FPGA on the SSRAM banks, in the order in which results list them.
enum class Port : std::uint8_t { kLeftLut, kRightLut, kLeftPixel, kRightPixel, kResult, kHost };
inline constexpr std::size_t kPortCount = 6;
inline constexpr std::array<const char*, kPortCount> kPortNames = {"left_lut",    "right_lut", "left_pixel",
                                                                   "right_pixel", "result",    "host"};
constexpr std::size_t index_of(Port port) { return static_cast<std::size_t>(port); }
constexpr const char* name_of(Port port) { return kPortNames[index_of(port)]; }

enum class BankKind : std::uint8_t {
  kZbtPipelined,    // read latency 2, no turnaround
  kZbtFlowThrough,  // read latency 1, no turnaround
  kSyncBurst,       // read latency 2, turnaround between the directions
};
inline constexpr std::array<const char*, 3> kBankKindNames = {"zbt_pipelined", "zbt_flow_through",
                                                              "sync_burst"};

// Cycles from the grant of a read to the cycle in which its reader can use the word (Cypress AN1090).
constexpr int read_latency_cycles(BankKind kind) { return kind == BankKind::kZbtFlowThrough ? 1 : 2; }

enum class ArbitrationPolicy : std::uint8_t { kFixedPriority, kRoundRobin };

struct ArbiterConfig {
  ArbitrationPolicy policy = ArbitrationPolicy::kFixedPriority;
  // Highest first; for round robin the order of the search. Each port once.
  std::array<Port, kPortCount> priority = {Port::kHost,       Port::kResult,  Port::kLeftPixel,
                                           Port::kRightPixel, Port::kLeftLut, Port::kRightLut};
};

struct SsramBankConfig {
  std::uint32_t words = 524288;  // 32-bit words, kBankWordsRule
  BankKind kind = BankKind::kZbtPipelined;
  int turnaround_cycles = 0;  // kTurnaroundRule for kSyncBurst; 0 and without effect for the others
  double clock_mhz = 40;      // of the bank's only clock, 1..1000
};

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const SsramBankConfig& config);
std::vector<std::string> problems(const ArbiterConfig& config);

}  // namespace stereotlm::memory
