#include "models/memory/bank_arbiter.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {
namespace {

using std::uint64_t;

// A bank with that turnaround, or with none.
SsramBankConfig bank_with(int turnaround) {
  return {16, turnaround > 0 ? BankKind::kSyncBurst : BankKind::kZbtPipelined, turnaround};
}
const SsramBankConfig kQdrBank{16, BankKind::kQdr};

// One cycle, decided and counted. Returns the ports that are granted.
PortMask arbitrate(BankArbiter& arbiter, uint64_t cycle, PortMask requests, PortMask writes) {
  const BankArbiter::Outcome outcome = arbiter.decide(cycle, requests, writes);
  arbiter.count(cycle, outcome);
  return BankArbiter::granted_in(outcome);
}

class Turnaround : public testing::TestWithParam<int> {};

TEST_P(Turnaround, GrantsTheOtherDirectionAtTurnaroundPlusOne) {
  const uint64_t ready = 10 + static_cast<uint64_t>(GetParam()) + 1;
  for (const PortMask first : {kHost, kNone}) {
    const auto second = static_cast<PortMask>(kHost ^ first);
    for (const uint64_t first_request : {uint64_t{11}, ready - 1, ready}) {
      BankArbiter arbiter(kFixedPriority, bank_with(GetParam()));
      ASSERT_EQ(arbitrate(arbiter, 10, kHost, first), kHost);
      for (uint64_t cycle = first_request; cycle < ready; ++cycle)
        EXPECT_EQ(arbitrate(arbiter, cycle, kHost, second), kNone) << cycle;
      EXPECT_EQ(arbitrate(arbiter, ready, kHost, second), kHost);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BankArbiter, Turnaround, testing::Values(1, 2, 7, 16));

TEST(BankArbiter, RefusesAWinnerBecauseOfTurnaroundEvenIfAnotherPortCouldBeGranted) {
  BankArbiter arbiter(kFixedPriority, bank_with(2));
  const PortMask both = kResult | kLeft;
  ASSERT_EQ(arbitrate(arbiter, 0, kLeft, kNone), kLeft);
  arbiter.begin_counting(1);
  EXPECT_EQ(arbitrate(arbiter, 1, both, kResult), kNone);
  EXPECT_EQ(arbitrate(arbiter, 2, both, kResult), kNone);
  EXPECT_EQ(arbitrate(arbiter, 3, both, kResult), kResult);
  arbiter.end_counting(4);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.turnaround_cycles, 2U);
  EXPECT_EQ(stats.blame[port::kResult][ArbiterStats::kTurnaround], 2U);
  EXPECT_EQ(stats.blame[port::kLeftPixel][ArbiterStats::kTurnaround], 2U);
  EXPECT_EQ(stats.blame[port::kLeftPixel][port::kResult], 1U);
}

struct Cycle {
  uint64_t number;
  PortMask requests;
  PortMask granted;
};

// The result port writes, all others read.
void expect_grants_by_age(int turnaround, std::initializer_list<Cycle> cycles) {
  BankArbiter arbiter(arbiter_of("age"), bank_with(turnaround));
  for (const Cycle& cycle : cycles)
    EXPECT_EQ(arbitrate(arbiter, cycle.number, cycle.requests, kResult), cycle.granted) << cycle.number;
}

TEST(AgeArbitration, GrantsTheOldestRequestAndEqualAgesByTheList) {
  expect_grants_by_age(0, {{0, kLeft | kRight, kLeft},
                           {1, kLeft | kRight, kRight},
                           {2, kResult | kLeft | kRight, kLeft},
                           {3, kResult | kRight, kResult},
                           {4, kResult | kRight, kRight}});
}

TEST(AgeArbitration, EndsAnAgeInACycleWithoutRequestAndNotBefore) {
  expect_grants_by_age(0, {{0, kLeft | kRight, kLeft}, {1, kHost | kRight, kRight}});
  expect_grants_by_age(0, {{0, kLeft | kRight, kLeft}, {1, kLeft, kLeft}, {2, kHost | kRight, kHost}});
  expect_grants_by_age(0, {{0, kLeft | kRight, kLeft}, {2, kHost | kRight, kHost}});
}

TEST(AgeArbitration, LetsTheWinnerAndAllOthersGrowOlderWhileTheBankTurnsRound) {
  expect_grants_by_age(
      2, {{0, kResult, kResult}, {1, kRight, kNone}, {2, kRight, kNone}, {3, kHost | kRight, kRight}});
  expect_grants_by_age(2, {{0, kResult, kResult},
                           {1, kLeft | kRight, kNone},
                           {2, kHost | kRight, kNone},
                           {3, kHost | kRight, kRight}});
  // The bank is ready: the request is granted, and its age ends.
  expect_grants_by_age(2, {{0, kResult, kResult}, {3, kRight, kRight}, {4, kHost | kRight, kHost}});
}

TEST(BankArbiter, WithSeparatePortsGrantsAReadAndAWriteAndBlamesWithinADirection) {
  BankArbiter arbiter(kFixedPriority, kQdrBank);
  arbiter.begin_counting(0);
  const PortMask all = kHost | kResult | kLeft | kRight;
  EXPECT_EQ(arbitrate(arbiter, 0, all, kHost | kResult), kHost | kLeft);
  EXPECT_EQ(arbitrate(arbiter, 1, kResult | kRight, kResult), kResult | kRight);
  EXPECT_EQ(arbitrate(arbiter, 2, kRight, kNone), kRight);
  EXPECT_EQ(arbitrate(arbiter, 3, kResult, kResult), kResult);
  EXPECT_EQ(arbitrate(arbiter, 4, kHost | kLeft | kResult, kResult), kHost | kResult);
  arbiter.end_counting(8);
  const ArbiterStats stats = arbiter.stats();
  EXPECT_EQ(stats.reads, 4U);
  EXPECT_EQ(stats.writes, 4U);
  EXPECT_EQ(stats.busy_cycles, 5U);
  EXPECT_EQ(stats.idle_cycles, 3U);
  EXPECT_EQ(stats.contended_cycles, 2U);  // in cycle 0 in both directions, in cycle 4 in one
  EXPECT_EQ(stats.turnaround_cycles, 0U);
  EXPECT_EQ(stats.blame[port::kResult][port::kHost], 1U);
  EXPECT_EQ(stats.blame[port::kRightPixel][port::kLeftPixel], 1U);
  EXPECT_EQ(stats.blame[port::kLeftPixel][port::kHost], 1U);
  EXPECT_EQ(stats.blame[port::kRightPixel][port::kHost], 0U);
}

TEST(BankArbiter, RefusesARequestOfAPortThatIsNotInThePriorityList) {
  for (const char* policy : {"fixed_priority", "round_robin", "age"}) {
    BankArbiter arbiter({policy, {1, 0}}, {16});
    EXPECT_EQ(BankArbiter::granted_in(arbiter.decide(0, 0b01, 0)), 0b01);
    EXPECT_THROW(arbiter.decide(1, 0b100, 0), std::invalid_argument);
    EXPECT_THROW(arbiter.decide(1, 0b101, 0), std::invalid_argument);
    EXPECT_THROW(arbiter.decide(1, 0, 0), std::invalid_argument);
    EXPECT_EQ(BankArbiter::granted_in(arbiter.decide(1, 0b10, 0)), 0b10);
  }
}

TEST(BankArbiter, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(BankArbiter(arbiter_of("lottery"), {}), std::invalid_argument);
  EXPECT_THROW(BankArbiter(kFixedPriority, {16, BankKind::kQdr, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::memory
