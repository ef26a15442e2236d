#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_events.h"
#include "tests/support/plain_trace.h"

// The PCI bus of contract sections 3 and 7.10, one data clock at a time.
namespace stereotlm::test {

using PlainWords = std::vector<std::uint32_t>;

class PlainTarget {
 public:
  virtual ~PlainTarget() = default;
  // Asked at the address clock of a write: how many of so many words the target takes.
  virtual std::size_t takes(std::size_t words) const { return words; }
  virtual void write(std::uint64_t word, const PlainWords& words) = 0;
  // Called at the address clock, which ends at `end_ps`. The target calls `answer` when it has the words. The
  // first is on the bus in the first clock after the answer, but not before the wait clocks have passed.
  virtual void read(std::uint64_t word, std::size_t count, PlainTime end_ps,
                    std::function<void(PlainWords)> answer) = 0;
};

// A burst of a master.
struct PlainBurst {
  bool write = true;
  PlainTarget* target = nullptr;  // null: no target answers
  int wait_clocks = 0;
  std::uint64_t word = 0;  // the first, of the target
  PlainWords words;        // of a read only their number counts
};

class PlainMaster {
 public:
  virtual ~PlainMaster() = default;
  // The address clock begins now.
  virtual PlainBurst burst() = 0;
  // The data clock of a word has ended.
  virtual void word_gone() {}
  // No target has taken the words of the burst, which ends now.
  virtual void lost() {}
  // The last data clock has ended, or the address clock if no word was taken. `words`: those transferred.
  virtual void ended(const PlainWords& words) = 0;
};

// The interface of a bus to its masters.
class PlainBus {
 public:
  virtual ~PlainBus() = default;
  // Masters take turns in the order of add().
  virtual std::size_t add(PlainMaster& master) = 0;
  // From now on, until it is granted.
  virtual void request(std::size_t master) = 0;
};

class PlainPciBus : public PlainBus {
 public:
  struct MasterStats {
    std::uint64_t transactions = 0;
    std::uint64_t words = 0;
    std::uint64_t wait_clocks = 0;
  };

  PlainPciBus(PlainEvents& events, const PlainNumber& mhz, int latency_timer_clocks, int width_bits)
      : events_(events),
        clock_(mhz),
        latency_timer_clocks_(static_cast<std::uint64_t>(latency_timer_clocks)),
        words_in_a_clock_(width_bits == 64 ? 2 : 1) {}

  std::size_t add(PlainMaster& master) override;
  void request(std::size_t master) override;

  // Both up to now.
  std::uint64_t clocks() const { return clock_.clocks_by(events_.now()); }
  std::uint64_t busy_clocks() const { return busy_clocks_ + (busy_ ? clocks() - address_clock_ : 0); }
  const std::vector<PlainBusBurst>& bursts() const { return bursts_; }
  const MasterStats& stats(std::size_t master) const { return slots_[master].stats; }

 private:
  struct Slot {
    PlainMaster* master = nullptr;
    std::optional<PlainTime> request_ps;
    MasterStats stats;
  };

  void await_grant();
  void grant(std::uint64_t clock);
  void begin(std::uint64_t clock);
  void begin_words(std::uint64_t clock, std::size_t words);
  void await_data(std::uint64_t clock);
  void end_data(std::uint64_t clock);
  bool another_waits(std::uint64_t clock) const;
  void end(std::uint64_t idle_clock);

  PlainEvents& events_;
  PlainClock clock_;
  std::uint64_t latency_timer_clocks_;
  int words_in_a_clock_;
  std::vector<Slot> slots_;
  std::size_t next_turn_ = 0;
  std::uint64_t free_clock_ = 0;  // the first that can be an address clock
  bool busy_ = false;
  std::uint64_t busy_clocks_ = 0;  // of bursts that have ended

  // The burst that has the bus.
  std::size_t owner_ = 0;
  std::uint64_t request_clock_ = 0;
  std::uint64_t address_clock_ = 0;
  PlainBurst burst_;
  std::size_t words_taken_ = 0;  // those that the target takes, or answers
  std::size_t words_done_ = 0;
  std::vector<PlainBusBurst> bursts_;  // that have ended
};

}  // namespace stereotlm::test
