#include "models/memory/bank_arbiter.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <numeric>
#include <string>
#include <vector>

#include "tests/unit/memory/step_arbiter.h"

namespace stereotlm::memory {
namespace {

using std::uint64_t;

constexpr PortMask kAll = 0x3F;
constexpr PortMask kNone = 0;

PortMask ports(std::initializer_list<Port> list) {
  PortMask mask = 0;
  for (const Port port : list) mask = static_cast<PortMask>(mask | mask_of(port));
  return mask;
}

ArbiterConfig unusual_order(ArbitrationPolicy policy) {
  return {policy,
          {Port::kRightLut, Port::kResult, Port::kLeftLut, Port::kHost, Port::kLeftPixel, Port::kRightPixel}};
}

// The first of the list, from `place` on, that asks.
std::size_t first_asking(const ArbiterConfig& config, std::size_t place, PortMask requests) {
  while ((requests & mask_of(config.priority[place % kPortCount])) == 0) ++place;
  return place % kPortCount;
}

TEST(BankArbiter, GrantsTheFirstOfTheListForEverySetOfRequests) {
  const ArbiterConfig config = unusual_order(ArbitrationPolicy::kFixedPriority);
  BankArbiter arbiter(config, 0);
  uint64_t cycle = 0;
  for (PortMask requests = 1; requests <= kAll; ++requests) {
    const Port winner = config.priority[first_asking(config, 0, requests)];
    EXPECT_EQ(arbitrate(arbiter, cycle++, requests, kNone), mask_of(winner)) << int{requests};
    EXPECT_EQ(arbitrate(arbiter, cycle++, requests, requests), mask_of(winner)) << int{requests};
  }
}

TEST(BankArbiter, PutsTheHostFirstByDefault) {
  BankArbiter arbiter(ArbiterConfig{}, 0);
  EXPECT_EQ(arbitrate(arbiter, 0, kAll, kNone), mask_of(Port::kHost));
  EXPECT_EQ(arbitrate(arbiter, 1, kAll & ~mask_of(Port::kHost), kNone), mask_of(Port::kResult));
  EXPECT_EQ(arbitrate(arbiter, 2, ports({Port::kRightLut, Port::kLeftLut}), kNone), mask_of(Port::kLeftLut));
}

TEST(BankArbiter, SearchesFromAfterTheLastOneGrantedForEverySetOfRequests) {
  const ArbiterConfig config = unusual_order(ArbitrationPolicy::kRoundRobin);
  for (std::size_t last = 0; last < kPortCount; ++last) {
    for (PortMask requests = 1; requests <= kAll; ++requests) {
      BankArbiter arbiter(config, 0);
      ASSERT_EQ(arbitrate(arbiter, 0, mask_of(config.priority[last]), kNone), mask_of(config.priority[last]));
      const Port winner = config.priority[first_asking(config, last + 1, requests)];
      EXPECT_EQ(arbitrate(arbiter, 1, requests, kNone), mask_of(winner)) << last << ' ' << int{requests};
    }
  }
}

TEST(BankArbiter, StartsTheRoundRobinFromTheHeadOfTheList) {
  const ArbiterConfig config = unusual_order(ArbitrationPolicy::kRoundRobin);
  BankArbiter arbiter(config, 0);
  for (uint64_t cycle = 0; cycle < 2 * kPortCount; ++cycle) {
    EXPECT_EQ(arbitrate(arbiter, cycle, kAll, kNone), mask_of(config.priority[cycle % kPortCount]));
  }
}

class Turnaround : public testing::TestWithParam<int> {};

TEST_P(Turnaround, GrantsTheOtherDirectionAtTurnaroundPlusOne) {
  const auto turnaround = static_cast<uint64_t>(GetParam());
  const PortMask port = mask_of(Port::kHost);
  for (const bool write_first : {false, true}) {
    const PortMask first = write_first ? port : kNone;
    const PortMask second = write_first ? kNone : port;
    BankArbiter early(ArbiterConfig{}, GetParam());
    ASSERT_EQ(arbitrate(early, 10, port, first), port);
    for (uint64_t cycle = 11; cycle <= 10 + turnaround; ++cycle) {
      EXPECT_EQ(arbitrate(early, cycle, port, second), kNone) << cycle;
    }
    EXPECT_EQ(arbitrate(early, 10 + turnaround + 1, port, second), port);

    BankArbiter first_asked_late(ArbiterConfig{}, GetParam());
    ASSERT_EQ(arbitrate(first_asked_late, 10, port, first), port);
    EXPECT_EQ(arbitrate(first_asked_late, 10 + turnaround, port, second), kNone);
    BankArbiter asked_in_time(ArbiterConfig{}, GetParam());
    ASSERT_EQ(arbitrate(asked_in_time, 10, port, first), port);
    EXPECT_EQ(arbitrate(asked_in_time, 10 + turnaround + 1, port, second), port);
  }
}

TEST_P(Turnaround, GrantsTheSameDirectionEveryCycle) {
  const PortMask port = mask_of(Port::kResult);
  for (const PortMask writes : {kNone, port}) {
    BankArbiter arbiter(ArbiterConfig{}, GetParam());
    for (uint64_t cycle = 0; cycle < 5; ++cycle) EXPECT_EQ(arbitrate(arbiter, cycle, port, writes), port);
  }
}

INSTANTIATE_TEST_SUITE_P(BankArbiter, Turnaround, testing::Values(1, 2, 7, 16));

TEST(BankArbiter, NeedsNoTurnaroundBeforeTheFirstAccess) {
  for (const PortMask writes : {kNone, kAll}) {
    BankArbiter arbiter(ArbiterConfig{}, 16);
    EXPECT_NE(arbitrate(arbiter, 0, kAll, writes), kNone);
  }
}

TEST(BankArbiter, GrantsBothDirectionsInTurnWithoutTurnaround) {
  BankArbiter arbiter(ArbiterConfig{}, 0);
  for (uint64_t cycle = 0; cycle < 6; ++cycle) {
    EXPECT_EQ(arbitrate(arbiter, cycle, kAll, cycle % 2 == 0 ? kAll : kNone), mask_of(Port::kHost));
  }
}

TEST(BankArbiter, ChoosesTheWinnerBeforeItLooksAtTheTurnaround) {
  // The pixel port could read, but the result port wins and must wait: nobody is granted.
  BankArbiter arbiter(ArbiterConfig{}, 2);
  const PortMask both = ports({Port::kResult, Port::kLeftPixel});
  const PortMask result = mask_of(Port::kResult);
  ASSERT_EQ(arbitrate(arbiter, 0, mask_of(Port::kLeftPixel), kNone), mask_of(Port::kLeftPixel));
  arbiter.begin_counting(1);
  EXPECT_EQ(arbitrate(arbiter, 1, both, result), kNone);
  EXPECT_EQ(arbitrate(arbiter, 2, both, result), kNone);
  EXPECT_EQ(arbitrate(arbiter, 3, both, result), result);
  arbiter.end_counting(4);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.turnaround_cycles, 2U);
  EXPECT_EQ(stats.blame[index_of(Port::kResult)][ArbiterStats::kTurnaround], 2U);
  EXPECT_EQ(stats.blame[index_of(Port::kLeftPixel)][ArbiterStats::kTurnaround], 2U);
  EXPECT_EQ(stats.blame[index_of(Port::kLeftPixel)][index_of(Port::kResult)], 1U);
}

TEST(BankArbiter, RefusesATurningWinnerEvenIfAnotherCouldGoAhead) {
  // Lower in the list and in the bank's own direction, alone it is granted at once.
  BankArbiter arbiter(ArbiterConfig{}, 2);
  ASSERT_EQ(arbitrate(arbiter, 0, mask_of(Port::kLeftPixel), kNone), mask_of(Port::kLeftPixel));
  ASSERT_EQ(arbitrate(arbiter, 1, ports({Port::kHost, Port::kLeftPixel}), mask_of(Port::kHost)), kNone);
  EXPECT_EQ(arbitrate(arbiter, 2, mask_of(Port::kLeftPixel), kNone), mask_of(Port::kLeftPixel));
}

TEST(BankArbiter, DoesNotMoveTheRoundRobinPlaceOnATurnaround) {
  const ArbiterConfig config{ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority};
  BankArbiter arbiter(config, 1);
  const PortMask host = mask_of(Port::kHost);
  const PortMask result = mask_of(Port::kResult);
  ASSERT_EQ(arbitrate(arbiter, 0, host, kNone), host);
  // From after the host: the result port wins, and waits one cycle; it is still the one to win.
  EXPECT_EQ(arbitrate(arbiter, 1, kAll, result), kNone);
  EXPECT_EQ(arbitrate(arbiter, 2, kAll, result), result);
  // The next in the list is a reader again.
  EXPECT_EQ(arbitrate(arbiter, 3, kAll, result), kNone);
  EXPECT_EQ(arbitrate(arbiter, 4, kAll, result), mask_of(Port::kLeftPixel));
}

TEST(BankArbiter, CountsWhatItGrantsAndWhomItRefuses) {
  BankArbiter arbiter(ArbiterConfig{}, 0);
  const PortMask left = mask_of(Port::kLeftPixel);
  const PortMask result = mask_of(Port::kResult);
  arbiter.begin_counting(100);
  arbitrate(arbiter, 102, left, kNone);  // two idle cycles before
  arbitrate(arbiter, 103, static_cast<PortMask>(left | result), result);
  arbitrate(arbiter, 104, static_cast<PortMask>(left | result), result);
  arbitrate(arbiter, 106, kAll, result);  // the host reads
  arbiter.end_counting(110);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.reads, 2U);
  EXPECT_EQ(stats.writes, 2U);
  EXPECT_EQ(stats.turnaround_cycles, 0U);
  EXPECT_EQ(stats.idle_cycles, 6U);
  EXPECT_EQ(stats.contended_cycles, 3U);
  EXPECT_EQ(stats.grants[index_of(Port::kLeftPixel)], 1U);
  EXPECT_EQ(stats.grants[index_of(Port::kResult)], 2U);
  EXPECT_EQ(stats.grants[index_of(Port::kHost)], 1U);
  EXPECT_EQ(stats.grants[index_of(Port::kLeftLut)], 0U);
  EXPECT_EQ(stats.blame[index_of(Port::kLeftPixel)][index_of(Port::kResult)], 2U);
  EXPECT_EQ(stats.blame[index_of(Port::kLeftPixel)][index_of(Port::kHost)], 1U);
  EXPECT_EQ(stats.blame[index_of(Port::kRightLut)][index_of(Port::kHost)], 1U);
  EXPECT_EQ(stats.blame[index_of(Port::kHost)][index_of(Port::kHost)], 0U);
  EXPECT_EQ(stats.reads + stats.writes + stats.turnaround_cycles + stats.idle_cycles, 10U);
  EXPECT_EQ(arbiter.uncounted_accesses(), 0U);
}

TEST(BankArbiter, CountsOnlyAccessesOutsideTheCountedCycles) {
  BankArbiter arbiter(ArbiterConfig{}, 2);
  const PortMask host = mask_of(Port::kHost);
  arbitrate(arbiter, 3, host, host);
  arbitrate(arbiter, 4, host, kNone);  // turning: no access
  arbiter.begin_counting(10);
  arbitrate(arbiter, 10, host, kNone);
  arbiter.end_counting(12);
  arbitrate(arbiter, 12, host, kNone);
  arbiter.begin_counting(20);
  arbiter.end_counting(21);
  EXPECT_EQ(arbiter.uncounted_accesses(), 2U);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.reads, 1U);
  EXPECT_EQ(stats.writes, 0U);
  EXPECT_EQ(stats.turnaround_cycles, 0U);
  EXPECT_EQ(stats.idle_cycles, 2U);  // 11 and 20
}

TEST(BankArbiter, CountsGrantsToAPortAloneWhereverTheyLay) {
  const ArbiterConfig config{ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority};
  BankArbiter arbiter(config, 0);
  const PortMask left = mask_of(Port::kLeftPixel);
  const PortMask result = mask_of(Port::kResult);
  arbiter.count_alone(left, false, 7);
  EXPECT_EQ(arbiter.uncounted_accesses(), 7U);
  arbiter.begin_counting(10);
  arbiter.count_alone(left, false, 4);
  arbiter.count_alone(result, true, 1);
  arbiter.count_alone(left, false, 0);
  arbiter.move_place_behind(left);
  arbiter.move_place_behind(result);
  // The place is behind the result port, the last that was granted.
  EXPECT_EQ(arbitrate(arbiter, 17, static_cast<PortMask>(left | result), result), left);
  arbiter.count_alone(left, false, 2);
  arbiter.end_counting(30);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.reads, 7U);
  EXPECT_EQ(stats.writes, 1U);
  EXPECT_EQ(stats.idle_cycles, 12U);
  EXPECT_EQ(stats.contended_cycles, 1U);
  EXPECT_EQ(stats.grants[index_of(Port::kLeftPixel)], 7U);
  EXPECT_EQ(arbiter.uncounted_accesses(), 7U);
}

TEST(BankArbiter, RemembersDirectionAndPlaceBetweenCountedPeriods) {
  const ArbiterConfig config{ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority};
  BankArbiter arbiter(config, 3);
  const PortMask host = mask_of(Port::kHost);
  arbiter.begin_counting(0);
  ASSERT_EQ(arbitrate(arbiter, 5, host, host), host);
  arbiter.end_counting(6);
  arbiter.begin_counting(8);
  EXPECT_EQ(arbitrate(arbiter, 8, kAll, kNone), kNone);                   // 5 + 3: still turning
  EXPECT_EQ(arbitrate(arbiter, 9, kAll, kNone), mask_of(Port::kResult));  // after the host
}

TEST(BankArbiter, BlamesEveryStalledRequestExactlyOnce) {
  const ArbiterConfig config = unusual_order(ArbitrationPolicy::kRoundRobin);
  BankArbiter arbiter(config, 2);
  arbiter.begin_counting(0);
  uint64_t stalls = 0;
  uint64_t grants = 0;
  std::uint32_t random = 1;
  for (uint64_t cycle = 0; cycle < 2000; ++cycle) {
    random = random * 1664525U + 1013904223U;
    const auto requests = static_cast<PortMask>(random >> 24U & kAll);
    const auto writes = static_cast<PortMask>(requests & (random >> 16U));
    if (requests == 0) continue;
    const PortMask granted = arbitrate(arbiter, cycle, requests, writes);
    ASSERT_EQ(granted & ~requests, 0);
    grants += uint64_t{granted != 0};
    for (std::size_t port = 0; port < kPortCount; ++port)
      stalls += (static_cast<unsigned>(requests & ~granted) >> port) & 1U;
  }
  arbiter.end_counting(2000);
  const ArbiterStats stats = arbiter.stats();
  uint64_t blamed = 0;
  for (const auto& row : stats.blame) blamed = std::accumulate(row.begin(), row.end(), blamed);
  EXPECT_EQ(blamed, stalls);
  EXPECT_EQ(std::accumulate(stats.grants.begin(), stats.grants.end(), uint64_t{0}), grants);
  EXPECT_EQ(stats.reads + stats.writes, grants);
  EXPECT_EQ(grants + stats.turnaround_cycles + stats.idle_cycles, 2000U);
}

// A result that writes and a pixel port that reads in turn, six cycles with the turnaround.
std::vector<BankArbiter::Outcome> step_in_turn(BankArbiter& arbiter, uint64_t cycle) {
  std::vector<BankArbiter::Outcome> outcomes;
  const PortMask result = mask_of(Port::kResult);
  const PortMask left = mask_of(Port::kLeftPixel);
  for (uint64_t i = 0; i < 3; ++i) {
    outcomes.push_back(arbiter.decide(cycle + i, result, result));
    arbiter.count(cycle + i, outcomes.back());
  }
  for (uint64_t i = 3; i < 6; ++i) {
    const PortMask both = ports({Port::kLeftPixel, Port::kRightPixel});
    outcomes.push_back(arbiter.decide(cycle + i, i == 5 ? both : left, kNone));
    arbiter.count(cycle + i, outcomes.back());
  }
  return outcomes;
}

class Repetition : public testing::TestWithParam<bool> {};

TEST_P(Repetition, CountsAndDecidesOnAsIfItHadBeenStepped) {
  const ArbiterConfig config{ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority};
  constexpr uint64_t kPeriod = 8;  // two cycles idle
  BankArbiter repeats(config, 1);
  BankArbiter steps(config, 1);
  for (BankArbiter* arbiter : {&repeats, &steps}) {
    if (GetParam()) arbiter->begin_counting(0);
    step_in_turn(*arbiter, 0);
  }
  const auto outcomes = step_in_turn(repeats, kPeriod);
  for (const BankArbiter::Outcome outcome : outcomes) repeats.count_skipped(outcome, 3);
  repeats.skip_to(repeats.state(2 * kPeriod - 2), 5 * kPeriod - 2, 3 * kPeriod);
  for (uint64_t period = 1; period < 5; ++period) step_in_turn(steps, period * kPeriod);
  EXPECT_EQ(repeats.state(5 * kPeriod - 2), steps.state(5 * kPeriod - 2));
  for (BankArbiter* arbiter : {&repeats, &steps}) {
    arbitrate(*arbiter, 5 * kPeriod - 2, kAll, kAll);
    if (GetParam()) arbiter->end_counting(100);
  }
  const ArbiterStats repeated = repeats.stats();
  const ArbiterStats stepped = steps.stats();
  EXPECT_EQ(repeats.uncounted_accesses(), steps.uncounted_accesses());
  EXPECT_EQ(repeated.reads, stepped.reads);
  EXPECT_EQ(repeated.writes, stepped.writes);
  EXPECT_EQ(repeated.turnaround_cycles, stepped.turnaround_cycles);
  EXPECT_EQ(repeated.idle_cycles, stepped.idle_cycles);
  EXPECT_EQ(repeated.contended_cycles, stepped.contended_cycles);
  EXPECT_EQ(repeated.grants, stepped.grants);
  EXPECT_EQ(repeated.blame, stepped.blame);
}

INSTANTIATE_TEST_SUITE_P(BankArbiter, Repetition, testing::Bool(), [](const auto& suite) {
  return std::string(suite.param ? "Counted" : "NotCounted");
});

TEST(BankArbiter, HasTheStateOfItsPlaceAndOfTheCyclesThatItStillTurnsRound) {
  const ArbiterConfig config{ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority};
  BankArbiter arbiter(config, 2);
  const std::uint32_t fresh = arbiter.state(0);
  EXPECT_EQ(fresh, arbiter.state(1000));
  arbitrate(arbiter, 10, mask_of(Port::kResult), kNone);
  EXPECT_NE(arbiter.state(11), arbiter.state(12));
  EXPECT_NE(arbiter.state(12), arbiter.state(13));
  EXPECT_EQ(arbiter.state(13), arbiter.state(14));  // 10 + turnaround + 1: ready
  EXPECT_NE(arbiter.state(14), fresh);              // the place is another
  const std::uint32_t after_read = arbiter.state(11);
  arbitrate(arbiter, 20, mask_of(Port::kResult), mask_of(Port::kResult));
  EXPECT_NE(arbiter.state(21), after_read);  // turning for the other direction
  arbitrate(arbiter, 30, mask_of(Port::kResult), kNone);
  EXPECT_EQ(arbiter.state(31), after_read);
}

TEST(BankArbiter, CountsAnOutcomeOfManyCyclesAtOnce) {
  BankArbiter at_once(ArbiterConfig{}, 0);
  BankArbiter one_by_one(ArbiterConfig{}, 0);
  const PortMask host = mask_of(Port::kHost);
  for (const bool counts : {false, true}) {
    const uint64_t first = counts ? 100 : 10;
    for (BankArbiter* arbiter : {&at_once, &one_by_one}) {
      if (counts) arbiter->begin_counting(first - 3);
    }
    at_once.count(first, at_once.decide(first, host, host), 5);
    for (uint64_t cycle = first; cycle < first + 5; ++cycle) arbitrate(one_by_one, cycle, host, host);
  }
  for (BankArbiter* arbiter : {&at_once, &one_by_one}) {
    arbiter->end_counting(110);
    EXPECT_EQ(arbiter->uncounted_accesses(), 5U);
    EXPECT_EQ(arbiter->stats().writes, 5U);
    EXPECT_EQ(arbiter->stats().idle_cycles, 3U + 5U);
  }
}

}  // namespace
}  // namespace stereotlm::memory
