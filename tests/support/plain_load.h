#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_events.h"
#include "tests/support/plain_pci_bus.h"

namespace stereotlm::test {

// A third-party master on the bus (board key `pci.load`).
struct PlainLoad {
  int burst_words = 0;
  PlainTime first_ps = 0;
  PlainTime interval_ps = 0;
  PlainTime access_ps = 0;
};

// The master reads its own device again and again.
class PlainLoadMaster : private PlainMaster, private PlainTarget {
 public:
  PlainLoadMaster(PlainEvents& events, PlainPciBus& bus, const PlainLoad& load)
      : events_(events), bus_(bus), load_(load), master_(bus.add(*this)) {
    await_transfer();
  }

 private:
  void await_transfer() {
    const PlainTime due = load_.first_ps + transfers_ * load_.interval_ps;
    events_.at(std::max(due, events_.now()), PlainPhase::kEffects, [this] { bus_.request(master_); });
  }
  PlainBurst burst() override {
    return {false, this, 0, 0, PlainWords(static_cast<std::size_t>(load_.burst_words) - words_done_)};
  }
  void ended(const PlainWords& words) override {
    words_done_ += words.size();
    if (words_done_ < static_cast<std::size_t>(load_.burst_words)) {
      bus_.request(master_);
      return;
    }
    words_done_ = 0;
    ++transfers_;
    await_transfer();
  }
  void read(std::uint64_t /*word*/, std::size_t count, PlainTime end_ps,
            std::function<void(PlainWords)> answer) override {
    events_.at(end_ps + load_.access_ps, PlainPhase::kEffects,
               [count, answer] { answer(PlainWords(count)); });
  }
  void write(std::uint64_t /*word*/, const PlainWords& /*words*/) override {}

  PlainEvents& events_;
  PlainPciBus& bus_;
  PlainLoad load_;
  std::size_t master_;
  std::uint64_t transfers_ = 0;
  std::size_t words_done_ = 0;
};

}  // namespace stereotlm::test
