#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/kernels/integer_rule.h"

namespace stereotlm::memory {

// The kinds of banks, as kBankTraits describes them.
enum class BankKind : std::uint8_t { kZbtPipelined, kZbtFlowThrough, kSyncBurst, kQdr, kSdram };

// Range of `turnaround_cycles` of a bank whose kind has turnaround.
inline constexpr kernels::IntegerRule kTurnaroundRule{1, 16};

// The properties of one kind of bank.
struct BankTraits {
  BankKind kind;     // its index in the table
  const char* name;  // in board files
  // From the grant of a read to the cycle in which its reader can use the word. Of sdram it is cas_latency
  // (SdramTiming), and this is 0.
  int read_latency_cycles;
  bool has_turnaround;  // cycles are lost between reads and writes; if not, turnaround_cycles is 0
  int ports;            // accesses that a bank can serve in a cycle; 2: one read and one write
};

// Every kind of bank, in the order of BankKind. Board files, their key list and explain's knobs follow from
// this table. Latencies: Cypress AN1090; qdr: QDR-II SRAM; sdram: SDR SDRAM, contract 8.3.
inline constexpr std::array kBankTraits = {
    BankTraits{BankKind::kZbtPipelined, "zbt_pipelined", 2, false, 1},
    BankTraits{BankKind::kZbtFlowThrough, "zbt_flow_through", 1, false, 1},
    BankTraits{BankKind::kSyncBurst, "sync_burst", 2, true, 1},
    BankTraits{BankKind::kQdr, "qdr", 2, false, 2},
    BankTraits{BankKind::kSdram, "sdram", 0, false, 1},
};

// `kind` must be one of the table.
constexpr const BankTraits& traits_of(BankKind kind) { return kBankTraits[static_cast<std::size_t>(kind)]; }

// Whether the bank has a port for reads and another for writes. Each of them serves one access in a cycle.
constexpr bool has_separate_ports(BankKind kind) { return traits_of(kind).ports == 2; }

// Whether the table has this kind.
constexpr bool is_bank_kind(BankKind kind) { return static_cast<std::size_t>(kind) < kBankTraits.size(); }

}  // namespace stereotlm::memory
