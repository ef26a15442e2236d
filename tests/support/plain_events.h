#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <stdexcept>
#include <utility>

#include "tests/support/plain_clock.h"

namespace stereotlm::test {

// The order of events at the same time.
enum class PlainPhase {
  kLocalBusEnds,    // a burst ends before others request the local bus at that time
  kEffects,         // words and bursts of the PCI bus end, registers are written, frames end and begin
  kPixels,          // a pixel arrives after a word has left the FIFO at that time
  kLocalBusBegins,  // the local bus decides among all requests up to that time
  kDecisions,       // the banks and the PCI bus decide likewise; captures begin
};

// The loop over all events of a simulation: one queue of functions.
class PlainEvents {
 public:
  PlainTime now() const { return now_; }

  void at(PlainTime time, PlainPhase phase, std::function<void()> action) {
    if (time < now_) throw std::logic_error("plain events: an event in the past");
    events_.push({time, phase, next_number_++, std::move(action)});
  }

  // Throws std::runtime_error if there is no event, or if too many have been run: something waits for ever.
  void run_next() {
    if (events_.empty() || ++events_run_ > kMostEvents) {
      throw std::runtime_error("plain events: nothing goes on at " + std::to_string(now_) + " ps");
    }
    const Event event = events_.top();
    events_.pop();
    now_ = event.time;
    event.action();
  }

  // Runs the events of the present time up to the decisions, which it leaves.
  void run_effects_of_now() {
    while (!events_.empty() && events_.top().time == now_ && events_.top().phase != PlainPhase::kDecisions)
      run_next();
  }

 private:
  static constexpr std::uint64_t kMostEvents = 200'000'000;
  struct Event {
    PlainTime time;
    PlainPhase phase;
    std::uint64_t number;  // events of one phase are run in the order in which they were made
    std::function<void()> action;
    bool operator<(const Event& other) const {  // the queue's top is its greatest
      if (time != other.time) return time > other.time;
      if (phase != other.phase) return phase > other.phase;
      return number > other.number;
    }
  };
  std::priority_queue<Event> events_;
  PlainTime now_ = 0;
  std::uint64_t next_number_ = 0;
  std::uint64_t events_run_ = 0;
};

}  // namespace stereotlm::test
