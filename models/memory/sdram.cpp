#include "models/memory/sdram.h"

namespace stereotlm::memory {

std::vector<std::string> problems(const SdramTiming& timing) {
  std::vector<std::string> found;
  kCasLatencyRule.check("cas_latency", timing.cas_latency, found);
  kRowWordsRule.check("row_words", timing.row_words, found);
  kInternalBanksRule.check("internal_banks", timing.internal_banks, found);
  kRowCyclesRule.check("activate_cycles", timing.activate_cycles, found);
  kRowCyclesRule.check("precharge_cycles", timing.precharge_cycles, found);
  if (!timing.refresh_interval_cycles) return found;
  kRefreshIntervalRule.check("refresh_interval_cycles", *timing.refresh_interval_cycles, found);
  kRefreshCyclesRule.check("refresh_cycles", timing.refresh_cycles, found);
  if (found.empty() && *timing.refresh_interval_cycles < least_refresh_interval(timing)) {
    found.push_back("refresh_interval_cycles = " + std::to_string(*timing.refresh_interval_cycles) +
                    ": must be at least " + std::to_string(least_refresh_interval(timing)) +
                    ", or no access might ever be granted");
  }
  return found;
}

bool SdramRows::may_access(std::uint64_t cycle, std::uint32_t word) {
  const std::uint32_t row = word / static_cast<std::uint32_t>(timing_.row_words);
  std::optional<std::uint32_t>& open = open_[row % static_cast<std::uint32_t>(timing_.internal_banks)];
  if (open == row) return true;
  be_busy(cycle, timing_.activate_cycles + (open ? timing_.precharge_cycles : 0), Cause::kRow);
  open = row;
  return cycle >= busy_until_;
}

std::pair<SdramRows::Counts, SdramRows::Counts> SdramRows::take(std::uint64_t end) {
  pass(end);
  Counts cycles{};
  Counts begun{};
  std::size_t left = 0;
  for (const Busy& busy : busy_) {
    const auto cause = static_cast<std::size_t>(busy.cause);
    const bool has_begun = busy.first < end;
    if (has_begun) {
      cycles[cause] += std::min(busy.end, end) - busy.first;
      begun[cause] += busy.is_counted ? 0 : 1;
    }
    if (busy.end > end || !has_begun)
      busy_[left++] = {std::max(busy.first, end), busy.end, busy.cause, has_begun || busy.is_counted};
  }
  busy_.resize(left);
  return {cycles, begun};
}

void SdramRows::set_busy_state(std::uint64_t cycle, std::uint64_t state) {
  next_refresh_ = next_refresh(cycle, state);
  busy_until_ = cycle + (state >> 2U);
  cause_ = (state >> 1U & 1U) != 0 ? Cause::kRefresh : Cause::kRow;
  busy_.clear();
  if (busy_until_ != cycle) busy_.push_back({cycle, busy_until_, cause_, true});
}

std::uint64_t SdramRows::next_refresh(std::uint64_t cycle, std::uint64_t state) const {
  const auto interval = static_cast<std::uint64_t>(timing_.refresh_interval_cycles.value_or(0));
  if (interval == 0) return 0;
  const bool is_late = (state & 1U) != 0;
  if (is_late) return (cycle - 1) / interval * interval;
  return std::max(interval, (cycle + interval - 1) / interval * interval);
}

// Begins the refreshes of the cycles before `end`. In those that have not been passed yet, nobody has opened
// a row.
void SdramRows::pass(std::uint64_t end) {
  while (next_refresh_ != 0 && std::max(busy_until_, next_refresh_) < end)
    begin_refresh(std::max(busy_until_, next_refresh_));
}

void SdramRows::begin_refresh(std::uint64_t cycle) {
  const bool is_open =
      std::any_of(open_.begin(), open_.end(), [](const auto& row) { return row.has_value(); });
  be_busy(cycle, timing_.refresh_cycles + (is_open ? timing_.precharge_cycles : 0), Cause::kRefresh);
  open_.fill(std::nullopt);
  next_refresh_ += static_cast<std::uint64_t>(*timing_.refresh_interval_cycles);
}

void SdramRows::be_busy(std::uint64_t first, int cycles, Cause cause) {
  busy_until_ = first + static_cast<std::uint64_t>(cycles);
  cause_ = cause;
  busy_.push_back({first, busy_until_, cause});
}

}  // namespace stereotlm::memory
