#include "tests/support/plain_pci_bus.h"

#include <algorithm>
#include <utility>

namespace stereotlm::test {

std::size_t PlainPciBus::add(PlainMaster& master) {
  slots_.push_back({&master, std::nullopt, {}});
  return slots_.size() - 1;
}

void PlainPciBus::request(std::size_t master) {
  if (slots_[master].request_ps) return;
  slots_[master].request_ps = events_.now();
  await_grant();
}

void PlainPciBus::await_grant() {
  if (busy_) return;
  for (const Slot& slot : slots_) {
    if (!slot.request_ps) continue;
    const std::uint64_t clock = std::max(free_clock_, clock_.first_edge(*slot.request_ps));
    events_.at(clock_.edge(clock), PlainPhase::kDecisions, [this, clock] { grant(clock); });
  }
}

void PlainPciBus::grant(std::uint64_t clock) {
  if (busy_) return;  // another master has been granted
  for (std::size_t turn = 0; turn < slots_.size(); ++turn) {
    const std::size_t master = (next_turn_ + turn) % slots_.size();
    Slot& slot = slots_[master];
    if (!slot.request_ps) continue;
    request_clock_ = clock_.first_edge(*slot.request_ps);
    slot.stats.wait_clocks += clock - request_clock_;
    slot.request_ps.reset();
    next_turn_ = (master + 1) % slots_.size();
    owner_ = master;
    begin(clock);
    return;
  }
}

void PlainPciBus::begin(std::uint64_t clock) {
  busy_ = true;
  address_clock_ = clock;
  burst_ = slots_[owner_].master->burst();
  words_done_ = 0;
  if (burst_.target == nullptr) {
    const std::uint64_t idle_clock = clock + 1 + 4;  // 4 clocks without DEVSEL#
    events_.at(clock_.edge(idle_clock), PlainPhase::kEffects, [this, idle_clock] { end(idle_clock); });
    return;
  }
  const std::uint64_t first_data_clock = clock + 1 + static_cast<std::uint64_t>(burst_.wait_clocks);
  if (burst_.write) {
    const std::size_t taken = burst_.target->takes(burst_.words.size());
    if (taken == 0) {
      events_.at(clock_.edge(clock + 1), PlainPhase::kEffects, [this, clock] { end(clock + 1); });
    } else {
      begin_words(first_data_clock, taken);
    }
    return;
  }
  burst_.target->read(
      burst_.word, burst_.words.size(), clock_.edge(clock + 1), [this, first_data_clock](PlainWords words) {
        burst_.words = std::move(words);
        begin_words(std::max(first_data_clock, clock_.first_edge(events_.now())), burst_.words.size());
      });
}

void PlainPciBus::begin_words(std::uint64_t clock, std::size_t words) {
  words_taken_ = words;
  await_data(clock);
}

void PlainPciBus::await_data(std::uint64_t clock) {
  events_.at(clock_.edge(clock + 1), PlainPhase::kEffects, [this, clock] { end_data(clock); });
}

// The data clock `clock` ends.
void PlainPciBus::end_data(std::uint64_t clock) {
  for (int word = 0; word < words_in_a_clock_ && words_done_ < words_taken_; ++word) {
    ++words_done_;
    slots_[owner_].master->word_gone();
  }
  const bool cut = clock >= address_clock_ + latency_timer_clocks_ && another_waits(clock);
  if (words_done_ == words_taken_ || cut) {
    end(clock + 1);
  } else {
    await_data(clock + 1);
  }
}

// Whether another master's request was pending as the clock began.
bool PlainPciBus::another_waits(std::uint64_t clock) const {
  for (std::size_t master = 0; master < slots_.size(); ++master) {
    const auto& request_ps = slots_[master].request_ps;
    if (master != owner_ && request_ps && *request_ps <= clock_.edge(clock)) return true;
  }
  return false;
}

// Called as the idle clock begins.
void PlainPciBus::end(std::uint64_t idle_clock) {
  busy_clocks_ += idle_clock - address_clock_;
  bursts_.push_back({owner_, burst_.write, 0, words_done_, clock_.edge(request_clock_),
                     clock_.edge(address_clock_), clock_.edge(address_clock_ + 1), clock_.edge(idle_clock)});
  free_clock_ = idle_clock + 1;
  busy_ = false;
  Slot& slot = slots_[owner_];
  ++slot.stats.transactions;
  slot.stats.words += words_done_;
  PlainWords words = std::move(burst_.words);
  words.resize(words_done_);
  if (burst_.write && words_done_ != 0) burst_.target->write(burst_.word, words);
  slot.master->ended(words);
  await_grant();
}

}  // namespace stereotlm::test
