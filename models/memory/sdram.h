#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::memory {

inline constexpr kernels::IntegerRule kCasLatencyRule{1, 8};              // cycles
inline constexpr kernels::IntegerRule kRowWordsRule{16, 65536, 1, true};  // 32-bit words
inline constexpr kernels::IntegerRule kInternalBanksRule{1, 8, 1, true};
inline constexpr kernels::IntegerRule kRowCyclesRule{0, 63};              // to activate or to precharge
inline constexpr kernels::IntegerRule kRefreshIntervalRule{64, 1000000};  // cycles
inline constexpr kernels::IntegerRule kRefreshCyclesRule{1, 255};         // cycles

// The timing of a bank of SDR SDRAM, in cycles of the core's clock (contract 8.3). The defaults are those of
// the MT48LC4M32B2 at 40 MHz.
struct SdramTiming {
  int cas_latency = 2;                               // read latency, kCasLatencyRule
  int row_words = 256;                               // 32-bit words of a row, kRowWordsRule
  int internal_banks = 4;                            // kInternalBanksRule
  int activate_cycles = 1;                           // to open a row, kRowCyclesRule
  int precharge_cycles = 1;                          // to close one, kRowCyclesRule
  std::optional<int> refresh_interval_cycles = 625;  // from one refresh to the next, kRefreshIntervalRule;
                                                     // nullopt: no refresh
  int refresh_cycles = 3;  // of a refresh, kRefreshCyclesRule; without effect if there is none

  friend bool operator==(const SdramTiming& a, const SdramTiming& b) {
    return a.cas_latency == b.cas_latency && a.row_words == b.row_words &&
           a.internal_banks == b.internal_banks && a.activate_cycles == b.activate_cycles &&
           a.precharge_cycles == b.precharge_cycles &&
           a.refresh_interval_cycles == b.refresh_interval_cycles && a.refresh_cycles == b.refresh_cycles;
  }
};

// The least interval with which an access is granted between two refreshes.
constexpr int least_refresh_interval(const SdramTiming& timing) {
  return std::max(2 * (timing.activate_cycles + timing.precharge_cycles) + timing.refresh_cycles,
                  timing.refresh_cycles + 1);
}

// Every broken rule as `field = value: rule`.
std::vector<std::string> problems(const SdramTiming& timing);

// The rows of one bank: which are open, and when a refresh or the opening of a row keeps the bank from any
// access. Plain C++; part of BankArbiter.
class SdramRows {
 public:
  // All rows are closed. The configuration has no problems.
  explicit SdramRows(const SdramTiming& timing)
      : timing_(timing),
        next_refresh_(static_cast<std::uint64_t>(timing.refresh_interval_cycles.value_or(0))) {}

  // To be called for each cycle with a request, before may_access(), in increasing order. A refresh that is
  // due begins. Returns the cause for which nobody is granted in the cycle, if there is one.
  enum class Cause : std::uint8_t { kRow, kRefresh };
  std::optional<Cause> busy_with(std::uint64_t cycle) {
    pass(cycle + 1);
    return cycle < busy_until_ ? std::optional(cause_) : std::nullopt;
  }
  // Whether the row of this word is open. If it is not, its opening begins in `cycle`, which busy_with() has
  // just found free. An opening may take no time: then the row is open at once.
  bool may_access(std::uint64_t cycle, std::uint32_t word);

  const SdramTiming& timing() const { return timing_; }  // the configured timing
  // Sets or returns the open row of an internal bank. nullopt: none is open.
  std::optional<std::uint32_t> open_row(std::size_t internal_bank) const { return open_[internal_bank]; }
  void set_open_row(std::size_t internal_bank, std::optional<std::uint32_t> row) {
    open_[internal_bank] = row;
  }
  // What keeps the bank busy from `cycle` on, as a word: take(cycle) has just been called. With
  // the open rows it is the state in `cycle`.
  std::uint64_t busy_state(std::uint64_t cycle) const {
    const std::uint64_t cycles = busy_until_ > cycle ? busy_until_ - cycle : 0;
    const bool is_refreshed = cycles != 0 && cause_ == Cause::kRefresh;
    return cycles << 2U | std::uint64_t{is_refreshed} << 1U |
           std::uint64_t{next_refresh_ != 0 && next_refresh_ < cycle};
  }
  void set_busy_state(std::uint64_t cycle, std::uint64_t state);  // takes over what busy_state() returned
  // The cycle in which the next refresh is due, from busy_state(cycle); it may be late. 0: never.
  std::uint64_t next_refresh(std::uint64_t cycle, std::uint64_t state) const;

  // Returns, of the cycles before `end` since the last call, those with an opening and with a refresh:
  // [Cause]; and how many of both have begun in them.
  using Counts = std::array<std::uint64_t, 2>;
  std::pair<Counts, Counts> take(std::uint64_t end);

 private:
  struct Busy {
    std::uint64_t first;
    std::uint64_t end;
    Cause cause;
    bool is_counted = false;  // among those that have begun
  };

  void pass(std::uint64_t end);
  void begin_refresh(std::uint64_t cycle);
  void be_busy(std::uint64_t first, int cycles, Cause cause);

  SdramTiming timing_;
  std::uint64_t next_refresh_;  // the cycle in which the next one is due; 0: never
  std::uint64_t busy_until_ = 0;
  Cause cause_ = Cause::kRow;                                                // up to busy_until_
  std::array<std::optional<std::uint32_t>, kInternalBanksRule.max> open_{};  // [internal bank]: its open row
  std::vector<Busy> busy_;                                                   // not yet taken
};

}  // namespace stereotlm::memory
