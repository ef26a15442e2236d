#include "models/fpga/local_bus_control.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "models/memory/memory_config.h"

namespace stereotlm::fpga {
namespace {

constexpr bool is_register(std::uint64_t address) { return address >= kLocalRegisters; }

double checked(double clock_mhz) {
  if (clock_mhz >= 1 && clock_mhz <= 1000) return clock_mhz;
  throw std::invalid_argument("clock_mhz = " + std::to_string(clock_mhz) + ": must be 1..1000");
}

}  // namespace

LocalBusControl::LocalBusControl(const LocalBusConfig& config, std::size_t banks, Core& core)
    : clock_(checked(config.clock_mhz)),
      banks_(banks),
      core_(core),
      buffers_(config.buffers),
      words_granted_(config.buffers) {
  memory::kBankCountRule.required("banks", static_cast<int>(banks));
}

LocalBusControl::Refusal LocalBusControl::refusal_of(const LocalBurst& burst) const {
  if (burst.address % 4 != 0) return Refusal::kAddress;
  if (is_register(burst.address)) return Refusal::kNone;
  if (memory::bank_of_address(burst.address) >= banks_) return Refusal::kAddress;
  const std::uint64_t last = burst.address + 4 * burst.words - 1;
  return memory::bank_of_address(last) == memory::bank_of_address(burst.address) ? Refusal::kNone
                                                                                 : Refusal::kLength;
}

bool LocalBusControl::begin_burst(std::uint64_t now_ps, const LocalBurst& burst) {
  if (refusal_of(burst) != Refusal::kNone) {
    count_error();
    return false;
  }
  begin(now_ps, burst);
  return true;
}

void LocalBusControl::begin(std::uint64_t now_ps, const LocalBurst& burst) {
  burst_ = burst;
  ok_ = true;
  next_word_ = 0;
  ++stats_.bursts;
  stats_.busy_clocks += idle_clock_ - address_clock_;
  // Bursts often follow each other without a pause.
  address_clock_ = now_ps == free_ps_ ? idle_clock_ + 1 : clock_.edge_at_or_after(now_ps);
  idle_clock_ = kUnknown;
  request_clock_ = address_clock_ + kFirstWordClock + 1;
  request_ps_ = clock_.edge_ps(request_clock_);
  if (is_register(burst.address)) {
    next_ps_ = request_ps_;
  } else {
    words_left_ = burst.words;
    core_.route({memory::bank_of_address(burst.address), burst.write, burst.address,
                 burst.address + 4 * burst.words});
  }
}

void LocalBusControl::access(std::uint64_t grant_ps, std::uint64_t usable_ps) {
  std::uint32_t word = 0;
  if (burst_.write) std::memcpy(&word, next_data(), 4);
  if (!core_.access_bank(grant_ps, burst_.write, next_address(), word)) {
    refuse_word();
  } else {
    count_words(1);
  }
  if (!burst_.write) std::memcpy(next_data(), &word, 4);
  advance(1, grant_ps, usable_ps);
}

void LocalBusControl::move_words(unsigned char* words) {
  std::memcpy(burst_.write ? words : next_data(), burst_.write ? next_data() : words, 4 * words_left_);
}

void LocalBusControl::count_granted(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps) {
  count_words(words);
  advance(words, grant_ps, usable_ps);
}

// `words` words have been granted: proceeds to the next word, or ends the burst.
void LocalBusControl::advance(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps) {
  next_word_ += words;
  words_left_ -= words;
  // Mostly each word is granted at once, in a cycle that begins with a clock of the bus.
  const std::uint64_t at_once = request_clock_ + words - 1;
  const std::uint64_t at_once_ps = words == 1 ? request_ps_ : clock_.edge_ps(at_once);
  const std::uint64_t clock = at_once_ps == grant_ps ? at_once : clock_.edge_at_or_after(grant_ps);
  if (words_left_ != 0) {
    request_clock_ = clock + 1;
    request_ps_ = clock_.edge_ps(request_clock_);
    return;
  }
  core_.route({});
  end(burst_.write || !ok_ ? clock : clock_.edge_at_or_after(usable_ps));
}

// Accesses the next register of the burst.
void LocalBusControl::step(std::uint64_t now_ps) {
  std::uint32_t word = 0;
  if (burst_.write) std::memcpy(&word, next_data(), 4);
  if (!core_.access_register(now_ps, burst_.write, next_address() - kLocalRegisters, word)) refuse_word();
  if (!burst_.write) std::memcpy(next_data(), &word, 4);
  ++stats_.register_accesses;
  ++next_word_;
  if (next_word_ < burst_.words) {
    next_ps_ = clock_.edge_ps(++request_clock_);
  } else {
    next_ps_ = kNever;
    end(request_clock_);
  }
}

void LocalBusControl::refuse_word() {
  ++stats_.errors;
  ok_ = false;
}

// Ends the burst; the bus is free after the idle clock.
void LocalBusControl::end(std::uint64_t idle_clock) {
  idle_clock_ = idle_clock;
  free_ps_ = clock_.edge_ps(idle_clock_ + 1);
  if (observer_ != nullptr) report();
  master_->end_burst_at(free_ps_, ok_);
}

void LocalBusControl::report() const {
  observer_->local_burst_ended({burst_.write, burst_.address, burst_.words, clock_.edge_ps(address_clock_),
                                clock_.edge_ps(address_clock_ + 1), clock_.edge_ps(idle_clock_), free_ps_});
}

LocalBusControl::Stats LocalBusControl::stats(std::uint64_t now_ps) const {
  Stats stats = stats_;
  stats.clocks = clock_.edge_at_or_after(now_ps + 1) - 1;
  const std::uint64_t end = std::min(idle_clock_, stats.clocks);
  stats.busy_clocks += end > address_clock_ ? end - address_clock_ : 0;
  return stats;
}

WordsByRange LocalBusControl::words_to_grant() const {
  WordsByRange words(buffers_);
  if (words_left_ != 0 && burst_.write) words.add(next_address(), words_left_);
  return words;
}

}  // namespace stereotlm::fpga
