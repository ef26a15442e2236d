// The control of the PCI bus without its module and without the kernel: which calls it needs, requests for
// later times, answers that come later, and grants that are not used. The tests of the module cover the clocks
// of bursts.
#include "models/pci/pci_bus_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::pci {
namespace {

using Times = std::vector<std::uint64_t>;

constexpr std::uint32_t kWindowBase = 0x1000;
constexpr std::uint64_t kWaitClocks = 4;
constexpr std::uint64_t kClockPs = 25'000;

// Runs its bursts one after the other. It requests the bus only when the test does.
class ListedMaster : public PciMasterIf {
 public:
  std::deque<PciBurst> bursts;
  Times granted_ps;
  std::vector<BurstResult> results;
  std::function<void()> on_begin = [] {};
  std::vector<std::uint32_t> words;

  // A burst of this number of words, which count up from 1.
  void add(bool write, std::size_t count, std::uint64_t address = kWindowBase) {
    words.resize(count);
    std::iota(words.begin(), words.end(), 1U);
    bursts.push_back({write, address, &words});
  }
  PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    granted_ps.push_back(address_clock_ps);
    on_begin();
    if (bursts.empty()) return {};
    const PciBurst burst = bursts.front();
    bursts.pop_front();
    return burst;
  }
  void end_burst(const BurstResult& result) override { results.push_back(result); }
};

// Answers when `answers` says, in the call or never. Reads return 100, 101, ..
class ListedTarget : public PciTarget {
 public:
  struct Access {
    std::uint64_t now_ps;
    std::uint64_t at_ps;
    std::vector<std::uint32_t> words;
  };
  std::function<PciAnswer(std::uint64_t)> answers = [](std::uint64_t at_ps) {
    return PciAnswer{at_ps, true};
  };
  std::vector<Access> accesses;

  PciAnswer access(std::uint64_t now_ps, const PciAccess& access, std::uint64_t at_ps) override {
    if (!access.write) std::iota(access.words, access.words + access.count, 100U);
    accesses.push_back({now_ps, at_ps, {access.words, access.words + access.count}});
    return answers(at_ps);
  }
};

// A clock of 40 MHz, a latency timer of 8 clocks, three masters and one target.
class PciBusControlTest : public testing::Test {
 protected:
  PciBusControlTest() { bus.bind(0, target); }
  static PciBusConfig config() {
    PciBusConfig config;
    config.clock_mhz = 40;
    config.latency_timer_clocks = 8;
    config.masters = {"m0", "m1", "m2"};
    config.windows = {{kWindowBase, 0x1000, static_cast<int>(kWaitClocks)}};
    return config;
  }
  void request(std::size_t master, std::uint64_t from_ps) {
    bus.slot(master).request(masters[master], from_ps);
  }
  void at(std::uint64_t time_ps, const std::function<void()>& action) { actions.emplace(time_ps, action); }
  void request_at(std::uint64_t clock, std::size_t master) {
    at(clock * kClockPs, [this, clock, master] { request(master, clock * kClockPs); });
  }
  // Runs everything in its order. All that happens at a time comes before the decision of that time.
  void run() {
    for (;;) {
      const std::uint64_t action_ps = actions.empty() ? kNever : actions.begin()->first;
      const std::uint64_t now_ps = std::min(bus.next_ps(), action_ps);
      if (now_ps == kNever) return;
      if (action_ps == now_ps) {
        const auto action = actions.begin()->second;
        actions.erase(actions.begin());
        action();
      } else {
        bus.decides_next() ? bus.decide(now_ps) : bus.step(now_ps);
      }
    }
  }

  PciBusControl bus{config()};
  ListedTarget target;
  std::array<ListedMaster, 3> masters;
  std::multimap<std::uint64_t, std::function<void()>> actions;
};

TEST_F(PciBusControlTest, NeedsADecisionAndAStepForABurstWhoseTargetAnswersAtOnce) {
  EXPECT_EQ(bus.next_ps(), kNever);
  for (const bool write : {true, false}) {
    const std::uint64_t first = write ? 3 : 20;  // the address clock
    masters[0].add(write, 5);
    request(0, first * kClockPs - 1);
    EXPECT_EQ(bus.next_ps(), first * kClockPs);
    EXPECT_TRUE(bus.decides_next());
    EXPECT_FALSE(bus.writes_next());
    bus.decide(first * kClockPs);
    EXPECT_EQ(bus.next_ps(), (first + 1 + kWaitClocks + 5) * kClockPs);
    EXPECT_FALSE(bus.decides_next());
    EXPECT_EQ(bus.writes_next(), write);
    EXPECT_EQ(target.accesses.size(), write ? 0U : 2U);
    bus.step(bus.next_ps());
    EXPECT_EQ(bus.next_ps(), kNever);
  }
  ASSERT_EQ(target.accesses.size(), 2U);
  EXPECT_EQ(target.accesses[0].now_ps, 13 * kClockPs);
  EXPECT_EQ(target.accesses[0].at_ps, 13 * kClockPs);
  EXPECT_EQ(target.accesses[0].words, (std::vector<std::uint32_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(target.accesses[1].now_ps, 20 * kClockPs);
  EXPECT_EQ(target.accesses[1].at_ps, 21 * kClockPs);
  EXPECT_EQ(masters[0].words, (std::vector<std::uint32_t>{100, 101, 102, 103, 104}));
}

TEST_F(PciBusControlTest, CallsNoTargetOfABurstThatEndsInAMasterAbort) {
  masters[0].add(true, 1, 0);
  request(0, 0);
  bus.decide(0);
  EXPECT_EQ(bus.next_ps(), 5 * kClockPs);
  EXPECT_FALSE(bus.writes_next());
  bus.step(5 * kClockPs);
  EXPECT_EQ(masters[0].results.at(0).end, BurstEnd::kMasterAbort);
  EXPECT_TRUE(target.accesses.empty());
}

// A free bus. A master may request it for a later time.
TEST_F(PciBusControlTest, DecidesForTheEarliestOfAllRequests) {
  for (ListedMaster& master : masters) master.add(true, 1);
  request(0, 50 * kClockPs);
  EXPECT_EQ(bus.next_ps(), 50 * kClockPs);
  request(1, 20 * kClockPs + 1);
  EXPECT_EQ(bus.next_ps(), 21 * kClockPs);
  request(2, 30 * kClockPs);
  EXPECT_EQ(bus.next_ps(), 21 * kClockPs);
  request(2, 0);  // a second request changes nothing
  EXPECT_EQ(bus.next_ps(), 21 * kClockPs);
  run();
  EXPECT_EQ(masters[1].granted_ps, Times{21 * kClockPs});
  EXPECT_EQ(masters[2].granted_ps, Times{30 * kClockPs});
  EXPECT_EQ(masters[0].granted_ps, Times{50 * kClockPs});
  for (const PciBusControl::MasterStats& stats : bus.stats(0).masters) EXPECT_EQ(stats.wait_clocks, 0U);
}

// A burst of 40 words, in data clocks 5..44. Its latency timer expires in clock 8.
struct LaterRequests {
  const char* name;
  std::vector<std::pair<std::size_t, std::uint64_t>> masters;  // requests, all made in clock 1: master, clock
  std::uint64_t last_clock;                                    // of the burst
};
class PciBusControlCuts : public PciBusControlTest, public testing::WithParamInterface<LaterRequests> {};

TEST_P(PciBusControlCuts, EndABurstInTheClockOfTheFirstRequestOfAnotherMaster) {
  for (ListedMaster& master : masters) master.add(true, 1);
  masters[0].bursts.clear();
  masters[0].add(true, 40);
  request(0, 0);
  at(kClockPs, [this] {
    for (const auto& [master, clock] : GetParam().masters) request(master, clock * kClockPs);
  });
  run();
  EXPECT_EQ(masters[0].results.at(0).words, GetParam().last_clock - kWaitClocks);
  EXPECT_EQ(masters[0].results[0].end_ps, (GetParam().last_clock + 1) * kClockPs);
}

INSTANTIATE_TEST_SUITE_P(PciBusControl, PciBusControlCuts,
                         testing::Values(LaterRequests{"timer", {{1, 7}}, 8},
                                         LaterRequests{"later", {{1, 20}}, 20},
                                         LaterRequests{"earlier_one_of_two", {{1, 30}, {2, 20}}, 20},
                                         LaterRequests{"later_one_of_two", {{1, 20}, {2, 30}}, 20},
                                         LaterRequests{"in_the_last_clock", {{1, 44}}, 44},
                                         LaterRequests{"its_own", {{0, 10}}, 44}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(PciBusControlTest, DoesNotCutABurstForARequestThatItsMasterMakesAsItBegins) {
  masters[0].add(true, 40);
  masters[0].on_begin = [this] { request(0, masters[0].granted_ps.back()); };
  request(0, 0);
  bus.decide(0);
  bus.step(bus.next_ps());
  EXPECT_EQ(masters[0].results.at(0).words, 40U);
  EXPECT_EQ(bus.next_ps(), 46 * kClockPs);
}

// A burst of 3 words whose target answers at a time of its own.
struct LaterAnswer {
  const char* name;
  bool write;
  bool ok;
  std::uint64_t answer_ps;
  std::uint64_t end_clock;  // of the burst
};
class PciBusControlAnswers : public PciBusControlTest, public testing::WithParamInterface<LaterAnswer> {};

TEST_P(PciBusControlAnswers, AreGivenInTheCallOrLaterWithTheSameEffect) {
  const LaterAnswer& given = GetParam();
  const PciAnswer answer = {given.answer_ps, given.ok};
  for (const bool in_the_call : {true, false}) {
    SCOPED_TRACE(in_the_call);
    PciBusControl other(config());
    other.bind(0, target);
    target.answers = [&](std::uint64_t) { return in_the_call ? answer : PciAnswer{kNever, true}; };
    ListedMaster master;
    master.add(given.write, 3);
    other.slot(0).request(master, 0);
    other.decide(0);
    if (given.write) other.step(other.next_ps());
    if (!in_the_call) {
      EXPECT_EQ(other.next_ps(), kNever);
      EXPECT_FALSE(other.decides_next());
      other.answer(given.answer_ps, answer);
    }
    while (other.next_ps() != kNever) other.step(other.next_ps());
    ASSERT_EQ(master.results.size(), 1U);
    EXPECT_EQ(master.results[0].end, given.ok ? BurstEnd::kComplete : BurstEnd::kTargetError);
    EXPECT_EQ(master.results[0].words, given.ok ? 3U : 0U);
    EXPECT_EQ(other.stats(given.end_clock * kClockPs).busy_clocks, given.end_clock);
    EXPECT_TRUE(other.decides_next());
  }
}

// The words of a write are transferred by clock 8. A read begins to transfer in clock 5, unless it waits.
INSTANTIATE_TEST_SUITE_P(PciBusControl, PciBusControlAnswers,
                         testing::Values(LaterAnswer{"write_with_its_last_word", true, true, 8 * kClockPs, 8},
                                         LaterAnswer{"write_a_ps_later", true, true, 8 * kClockPs + 1, 9},
                                         LaterAnswer{"refused_write", true, false, 10 * kClockPs, 10},
                                         LaterAnswer{"read_within_the_wait_clocks", false, true, 5 * kClockPs,
                                                     8},
                                         LaterAnswer{"read_a_ps_later", false, true, 5 * kClockPs + 1, 9},
                                         LaterAnswer{"refused_read", false, false, 6 * kClockPs, 7}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(PciBusControlTest, CutsAReadForARequestMadeBeforeItsTargetAnswers) {
  target.answers = [](std::uint64_t) { return PciAnswer{kNever, true}; };
  masters[0].add(false, 10);
  masters[1].add(true, 1);
  request(0, 0);
  request_at(3, 1);
  at(12 * kClockPs, [this] {
    target.answers = [](std::uint64_t at_ps) { return PciAnswer{at_ps, true}; };
    bus.answer(12 * kClockPs, {12 * kClockPs, true});
  });
  run();
  EXPECT_EQ(masters[0].results.at(0).end, BurstEnd::kLatencyTimer);
  EXPECT_EQ(masters[0].results[0].words, 1U);
  EXPECT_EQ(masters[0].results[0].first_data_clock, 12U);
  EXPECT_EQ(masters[1].granted_ps, Times{14 * kClockPs});
}

TEST_F(PciBusControlTest, ShowsNoWordsOfAMasterWhoseBurstDoesNotRun) {
  masters[0].add(true, 3);
  request(0, 0);
  bus.decide(0);
  EXPECT_EQ(bus.slot(0).transferred(7 * kClockPs).words, 2U);
  EXPECT_EQ(bus.slot(1).transferred(7 * kClockPs).words, 0U);
  bus.step(8 * kClockPs);
  EXPECT_EQ(bus.slot(0).transferred(8 * kClockPs).words, 0U);
}

TEST_F(PciBusControlTest, CountsTheClocksFromTheFirstRequestToItsAddressClock) {
  for (ListedMaster& master : masters) master.add(true, 4);
  request_at(0, 0);                                                  // clocks 0..8, idle clock 9
  request_at(2, 1);                                                  // address clock 10
  request_at(5, 1);                                                  // repeated
  at(3 * kClockPs + 1, [this] { request(2, 3 * kClockPs + 1); });    // counts from clock 4; address clock 20
  at(12 * kClockPs + 1, [this] { request(1, 12 * kClockPs + 1); });  // while its burst runs, and unused
  run();
  const auto stats = bus.stats(36 * kClockPs);
  EXPECT_EQ(stats.masters[0].wait_clocks, 0U);
  EXPECT_EQ(stats.masters[1].wait_clocks, 8U);
  EXPECT_EQ(stats.masters[2].wait_clocks, 16U);
  EXPECT_EQ(stats.masters[1].transactions, 1U);
  EXPECT_EQ(stats.busy_clocks, 27U);
}

TEST_F(PciBusControlTest, KnowsTheEarliestRequestOfAllMastersButSome) {
  request(0, 5 * kClockPs);
  request(2, 3 * kClockPs);
  const auto beside = [&](PciBusControl::Masters some) { return bus.earliest_request_beside(some); };
  EXPECT_EQ(beside(0), 3U);
  EXPECT_EQ(beside(PciBusControl::mask_of(0)), 3U);
  EXPECT_EQ(beside(PciBusControl::mask_of(2)), 5U);
  EXPECT_EQ(beside(PciBusControl::mask_of(0) | PciBusControl::mask_of(2)), kNever);
}

// A burst of master 0 is stepped or skipped, while master 1 requests a later clock.
TEST_F(PciBusControlTest, IsInTheSameStateAfterABurstThatIsSkipped) {
  PciBusControl skipping(config());
  skipping.bind(0, target);
  const auto request_both = [&](PciBusControl& control) {
    control.slot(0).request(masters[0], 2 * kClockPs);
    control.slot(1).request(masters[1], 40 * kClockPs);
  };
  request_both(bus);
  request_both(skipping);
  masters[0].add(true, 3);
  bus.decide(bus.next_ps());
  bus.step(bus.next_ps());
  EXPECT_EQ(skipping.decision_clock(), 2U);
  skipping.skip_bursts(0, bus.counts(0));
  EXPECT_EQ(skipping.request_clock(0), kNever);
  skipping.skip_to(bus.position(), bus.busy_clocks());
  EXPECT_EQ(bus.busy_clocks(), 1 + kWaitClocks + 3);
  EXPECT_EQ(bus.position().free_clock, 2 + 1 + kWaitClocks + 3 + 1);
  for (const PciBusControl* control : {&bus, &skipping}) {
    EXPECT_EQ(control->next_ps(), 40 * kClockPs);
    EXPECT_EQ(control->decision_clock(), 40U);
    EXPECT_EQ(control->position().last_granted, 0U);
    EXPECT_EQ(control->position().free_clock, bus.position().free_clock);
    EXPECT_EQ(control->transactions(), 1U);
    const PciBusControl::Stats stats = control->stats(30 * kClockPs);
    EXPECT_EQ(stats.busy_clocks, bus.busy_clocks());
    EXPECT_EQ(stats.masters[0].words, 3U);
    EXPECT_EQ(stats.masters[0].wait_clocks, 0U);
  }
}

TEST_F(PciBusControlTest, PassesAnUnusedGrantToTheNextMasterInTheSameClock) {
  masters[2].add(true, 1);
  for (const std::size_t master : {0U, 1U, 2U}) request_at(5, master);
  run();
  for (const ListedMaster& master : masters) EXPECT_EQ(master.granted_ps, Times{5 * kClockPs});
  EXPECT_EQ(bus.stats(0).masters[0].transactions, 0U);
  EXPECT_EQ(masters[2].results.size(), 1U);
}

TEST_F(PciBusControlTest, CountsAnUnusedGrantAsTheTurnOfItsMaster) {
  request_at(0, 0);  // without a burst
  at(5 * kClockPs, [this] {
    for (const std::size_t master : {0U, 1U}) {
      masters[master].add(true, 1);
      request(master, 5 * kClockPs);
    }
  });
  run();
  EXPECT_EQ(masters[1].granted_ps, Times{5 * kClockPs});
  EXPECT_EQ(masters[0].granted_ps, (Times{0, 12 * kClockPs}));
}

TEST_F(PciBusControlTest, GrantsTheNextClockToAMasterThatRequestsAgainAsItReturnsItsGrant) {
  masters[0].on_begin = [this] {
    const std::size_t grants = masters[0].granted_ps.size();
    if (grants < 4) {
      request(0, masters[0].granted_ps.back());
    } else {
      masters[0].add(true, 1);
    }
  };
  request_at(5, 0);
  run();
  EXPECT_EQ(masters[0].granted_ps, (Times{5 * kClockPs, 6 * kClockPs, 7 * kClockPs, 8 * kClockPs}));
  EXPECT_EQ(bus.stats(20 * kClockPs).busy_clocks, 1 + kWaitClocks + 1);
}

class ListedBursts : public PciBusObserver {
 public:
  void pci_burst_ended(const EndedPciBurst& burst) override { bursts.push_back(burst); }
  std::vector<EndedPciBurst> bursts;
};

// Master 1 requests while the burst of master 0 runs, which its latency timer cuts in clock 10. Master 2 finds no
// target.
TEST_F(PciBusControlTest, ShowsEachBurstAtItsEndToAnObserver) {
  ListedBursts observer;
  bus.observe(observer);
  masters[0].add(true, 40, kWindowBase + 8);
  masters[1].add(false, 2);
  masters[2].add(true, 1, 0);
  request(0, 2 * kClockPs - 1);
  request_at(6, 1);
  request_at(7, 2);
  at(9 * kClockPs, [&] { EXPECT_TRUE(observer.bursts.empty()); });
  run();
  struct Expected {
    std::size_t master;
    std::optional<std::size_t> window;
    bool write;
    std::uint64_t address;
    std::uint64_t words;
    std::uint64_t request;  // clock
    std::uint64_t begin;
    std::uint64_t end;
  };
  // Address clock, 4 wait clocks, words; or address clock and 4 clocks without target. Then an idle clock.
  const std::vector<Expected> expected = {{0, 0, true, kWindowBase + 8, 4, 2, 2, 11},
                                          {1, 0, false, kWindowBase, 2, 6, 12, 19},
                                          {2, std::nullopt, true, 0, 0, 7, 20, 25}};
  ASSERT_EQ(observer.bursts.size(), expected.size());
  for (std::size_t index = 0; index < expected.size(); ++index) {
    SCOPED_TRACE(index);
    const EndedPciBurst& burst = observer.bursts[index];
    EXPECT_EQ(burst.master, expected[index].master);
    EXPECT_EQ(burst.window, expected[index].window);
    EXPECT_EQ(burst.write, expected[index].write);
    EXPECT_EQ(burst.address, expected[index].address);
    EXPECT_EQ(burst.words, expected[index].words);
    EXPECT_EQ(burst.request_ps, expected[index].request * kClockPs);
    EXPECT_EQ(burst.address_ps, expected[index].begin * kClockPs);
    EXPECT_EQ(burst.data_ps, (expected[index].begin + 1) * kClockPs);
    EXPECT_EQ(burst.end_ps, expected[index].end * kClockPs);
  }
}

}  // namespace
}  // namespace stereotlm::pci
