#include "tests/support/plain_pci_bus.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

namespace stereotlm::test {
namespace {

constexpr PlainTime kClockPs = 100'000;  // 10 MHz
constexpr int kWaitClocks = 4;

class Target : public PlainTarget {
 public:
  void write(std::uint64_t /*word*/, const PlainWords& words) override { taken = words; }
  void read(std::uint64_t /*word*/, std::size_t count, PlainTime /*end_ps*/,
            std::function<void(PlainWords)> answer) override {
    answer(PlainWords(count));
  }
  PlainWords taken;
};

// A master with one burst.
class Master : public PlainMaster {
 public:
  Master(PlainEvents& events, PlainPciBus& bus, Target& target, PlainWords words, bool write = true)
      : events_(events), burst_{write, &target, kWaitClocks, 0, std::move(words)} {
    bus.request(bus.add(*this));
  }
  PlainBurst burst() override {
    address_clock = events_.now() / kClockPs;
    return burst_;
  }
  void word_gone() override { gone_at.push_back(events_.now() / kClockPs); }
  void ended(const PlainWords& words) override {
    transferred = words;
    has_ended = true;
  }

  PlainTime address_clock = 0;
  std::vector<PlainTime> gone_at;  // clocks that begin as a word has left
  PlainWords transferred;
  bool has_ended = false;

 private:
  PlainEvents& events_;
  PlainBurst burst_;
};

struct Expected {
  int width_bits;
  bool write;
  int latency_timer_clocks;
  std::vector<PlainTime> gone_at;
  PlainTime next_address_clock;
};

// The example of contract section 7.10.
TEST(PlainPciBus, TransfersOneWordAClockOrTwo) {
  const PlainWords words = {10, 11, 12, 13, 14};
  const std::vector<Expected> cases = {{32, true, 64, {6, 7, 8, 9, 10}, 11},
                                       {32, false, 64, {6, 7, 8, 9, 10}, 11},
                                       {64, true, 64, {6, 6, 7, 7, 8}, 9},
                                       {64, false, 64, {6, 6, 7, 7, 8}, 9},
                                       {32, true, 6, {6, 7}, 8},
                                       {64, true, 6, {6, 6, 7, 7}, 8},
                                       {64, true, 7, {6, 6, 7, 7, 8}, 9}};
  for (const Expected& expected : cases) {
    SCOPED_TRACE(std::to_string(expected.width_bits) + " bits, timer " +
                 std::to_string(expected.latency_timer_clocks));
    PlainEvents events;
    PlainPciBus bus(events, plain_number("10"), expected.latency_timer_clocks, expected.width_bits);
    Target target;
    Master first(events, bus, target, words, expected.write);
    Master second(events, bus, target, {20});
    while (!first.has_ended) events.run_next();
    EXPECT_EQ(first.address_clock, 0U);
    EXPECT_EQ(first.gone_at, expected.gone_at);
    EXPECT_EQ(first.transferred.size(), expected.gone_at.size());
    EXPECT_EQ(bus.stats(0).words, expected.gone_at.size());
    EXPECT_EQ(bus.busy_clocks(), expected.gone_at.back());
    if (expected.write) {
      EXPECT_EQ(target.taken, PlainWords(words.begin(), words.begin() + expected.gone_at.size()));
    }
    while (!second.has_ended) events.run_next();
    EXPECT_EQ(second.address_clock, expected.next_address_clock);
  }
}

}  // namespace
}  // namespace stereotlm::test
