#include "models/memory/arbitration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/unit/memory/plain_arbiter.h"
#include "tests/unit/support/random_memory.h"

namespace stereotlm::memory {
namespace {

using test::random_arbiter;
using test::SplitMix64;

constexpr int kBanks = 5;

// Banks without turnaround, two with, and one with separate ports.
std::vector<SsramBankConfig> banks() {
  return {{16},
          {16, BankKind::kZbtFlowThrough},
          {16, BankKind::kSyncBurst, 2},
          {16, BankKind::kSyncBurst, 9},
          {16, BankKind::kQdr}};
}

// Every port gets a route, or most of them.
struct Routes {
  explicit Routes(SplitMix64& random) {
    for (std::size_t port = 0; port < kPortCount; ++port) {
      if (random.chance(10)) continue;
      bank[port] = static_cast<std::size_t>(random.between(0, kBanks - 1));
      ports = static_cast<PortMask>(ports | 1U << port);
      if (random.chance(40)) writes = static_cast<PortMask>(writes | 1U << port);
    }
  }
  void apply(Arbitration& arbitration) const {
    for (Port port = 0; port < kPortCount; ++port) {
      arbitration.unroute(port);
      if ((ports & mask_of(port)) != 0) arbitration.route(port, bank[port], (writes & mask_of(port)) != 0);
    }
  }
  // The requests for one bank.
  PortMask of_bank(std::size_t number, PortMask requests) const {
    PortMask mask = 0;
    for (std::size_t port = 0; port < kPortCount; ++port)
      mask = static_cast<PortMask>(mask | (bank[port] == number ? requests & 1U << port : 0U));
    return mask;
  }
  void visit(Port port, std::size_t to, bool write) {
    bank[port] = to;
    ports = static_cast<PortMask>(ports | mask_of(port));
    writes = static_cast<PortMask>((writes & ~mask_of(port)) | (write ? mask_of(port) : kNone));
  }
  PortMask random_requests(SplitMix64& random) const {
    return random.chance(20) ? kNone : static_cast<PortMask>(random.next() & ports);
  }

  std::array<std::size_t, kPortCount> bank{};
  PortMask ports = 0;
  PortMask writes = 0;
};

TEST(Arbitration, GrantsAndCountsAsOneArbiterPerBank) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SplitMix64 random(seed);
    const ArbiterConfig config = random_arbiter(random);
    Arbitration arbitration(config, banks());
    std::vector<PlainArbiter> plain;
    for (const SsramBankConfig& bank : banks()) plain.emplace_back(config, bank);
    std::uint64_t cycle = 0;
    for (int part = 0; part < 6; ++part) {
      Routes routes(random);
      routes.apply(arbitration);
      const int visits = random.chance(50) ? 0 : random.between(1, 50);  // percent
      const bool counts = part % 2 == 1;
      for (PlainArbiter& arbiter : plain) arbiter.counts = counts;
      if (counts) arbitration.begin_counting(cycle);
      for (const std::uint64_t end = cycle + 100; cycle < end; ++cycle) {
        if (random.chance(visits)) {
          routes.visit(port::kHost, static_cast<std::size_t>(random.between(0, kBanks - 1)),
                       random.chance(50));
          arbitration.visit(port::kHost, routes.bank[port::kHost], (routes.writes & kHost) != 0);
        }
        const PortMask requests = routes.random_requests(random);
        PortMask granted = 0;
        for (std::size_t bank = 0; bank < plain.size(); ++bank)
          granted |= plain[bank].step(routes.of_bank(bank, requests), routes.writes);
        ASSERT_EQ(arbitration.arbitrate(cycle, requests), granted) << cycle;
      }
      if (counts) arbitration.end_counting(cycle);
      ASSERT_EQ(texts_of(arbitration.arbiters()), texts_of(plain)) << part;
    }
  }
}

class SkippedArbitration : public testing::TestWithParam<bool> {};

// Two with the same routes, counting or not: one steps every cycle; the other records the cycles between two
// states, and skips them wherever it is in the first of these states again. The host may visit shared banks
// in between.
TEST_P(SkippedArbitration, EqualsTheSteppedOneInGrantsStatesAndCounts) {
  int skipped = 0;
  int repeated = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SplitMix64 random(seed);
    const ArbiterConfig config = random_arbiter(random);
    Routes routes(random);
    const bool visits = random.chance(50);
    Arbitration skips(config, banks());
    Arbitration steps(config, banks());
    std::uint64_t cycle = 3;
    for (Arbitration* arbitration : {&skips, &steps}) {
      routes.apply(*arbitration);
      if (GetParam()) arbitration->begin_counting(cycle);
    }
    struct Span {
      Arbitration::State begin;
      std::size_t host_bank;
      PortMask writes;
      std::vector<PortMask> requests;
      Arbitration::Decided decided;
      Arbitration::State end;
    };
    std::vector<Span> spans;
    for (int part = 0; part < 60; ++part) {
      const auto bank = static_cast<std::size_t>(random.between(0, kBanks - 1));
      if (visits && steps.is_shared(bank)) {
        routes.visit(port::kHost, bank, random.chance(50));
        for (Arbitration* arbitration : {&skips, &steps})
          arbitration->visit(port::kHost, bank, (routes.writes & kHost) != 0);
      }
      const Arbitration::State now = steps.state(cycle);
      ASSERT_EQ(skips.state(cycle), now);
      const auto known = std::find_if(spans.begin(), spans.end(), [&](const Span& span) {
        return span.begin == now && span.host_bank == routes.bank[port::kHost] &&
               span.writes == routes.writes;
      });
      if (known != spans.end()) {
        const bool recurs = known->begin == known->end;
        const auto times = static_cast<std::uint64_t>(recurs ? random.between(1, 5) : 1);
        for (std::uint64_t i = 0; i < times; ++i) {
          for (const PortMask requests : known->requests) steps.arbitrate(cycle++, requests);
        }
        skips.count_skipped(known->decided, times);
        skips.skip_to(known->end, cycle, times * known->requests.size());
        ++(recurs ? repeated : skipped);
        if (recurs) spans.erase(known);
        continue;
      }
      Span span{now, routes.bank[port::kHost], routes.writes, {}, {}, {}};
      skips.begin_recording();
      for (int cycles = random.between(1, 12); cycles > 0; --cycles) {
        span.requests.push_back(routes.random_requests(random));
        ASSERT_EQ(skips.arbitrate(cycle, span.requests.back()), steps.arbitrate(cycle, span.requests.back()));
        ++cycle;
        if (random.chance(20)) skips.arbiters();  // a query changes nothing
      }
      span.decided = skips.take_recorded();
      span.end = steps.state(cycle);
      spans.push_back(span);
    }
    for (Arbitration* arbitration : {&skips, &steps}) {
      if (GetParam()) arbitration->end_counting(cycle);
    }
    ASSERT_EQ(texts_of(skips.arbiters()), texts_of(steps.arbiters()));
  }
  EXPECT_GT(skipped, 100);
  EXPECT_GT(repeated, 100);
}

INSTANTIATE_TEST_SUITE_P(Arbitration, SkippedArbitration, testing::Bool(), [](const auto& suite) {
  return std::string(suite.param ? "Counted" : "NotCounted");
});

// Round robin: left_pixel is before right_pixel, unless it was the last that was granted.
PortMask granted_after_being_alone(std::uint64_t grants, std::uint64_t retracted) {
  Arbitration arbitration(kRoundRobin, banks());
  arbitration.route(port::kLeftPixel, 0, false);
  for (std::uint64_t cycle = 0; cycle < grants; ++cycle) arbitration.arbitrate(cycle, kLeft);
  EXPECT_EQ(arbitration.arbiters()[0].uncounted_accesses(), grants);
  arbitration.retract_grants(port::kLeftPixel, retracted);
  EXPECT_EQ(arbitration.arbiters()[0].uncounted_accesses(), grants - retracted);
  arbitration.route(port::kRightPixel, 0, false);
  return arbitration.arbitrate(grants, kLeft | kRight);
}

TEST(Arbitration, MovesNoPlaceForGrantsThatAreRetractedAfterAQuery) {
  EXPECT_EQ(granted_after_being_alone(0, 0), kLeft);
  EXPECT_EQ(granted_after_being_alone(5, 5), kLeft);
  EXPECT_EQ(granted_after_being_alone(5, 4), kRight);
  EXPECT_EQ(granted_after_being_alone(1, 0), kRight);
}

// As before, with a visit of the host before the grants are retracted.
PortMask granted_after_a_visit(std::size_t bank, std::uint64_t retracted) {
  Arbitration arbitration(kRoundRobin, banks());
  arbitration.route(port::kLeftPixel, 0, false);
  for (std::uint64_t cycle = 0; cycle < 5; ++cycle) arbitration.arbitrate(cycle, kLeft);
  arbitration.visit(port::kHost, bank, false);
  arbitration.retract_grants(port::kLeftPixel, retracted);
  arbitration.route(port::kRightPixel, 0, false);
  return arbitration.arbitrate(5, kLeft | kRight);
}

TEST(Arbitration, MovesThePlaceOfAVisitedBankOnly) {
  EXPECT_EQ(granted_after_a_visit(1, 5), kLeft);
  EXPECT_EQ(granted_after_a_visit(1, 4), kRight);
  EXPECT_EQ(granted_after_a_visit(0, 0), kRight);
}

TEST(Arbitration, HasAStateOnlyWherePortsContendOrTheBankHasTurnaround) {
  Arbitration arbitration(kRoundRobin, banks());
  const Arbitration::State none{};
  arbitration.route(port::kLeftPixel, 0, false);
  arbitration.arbitrate(0, kLeft);
  EXPECT_EQ(arbitration.state(1), none);
  arbitration.route(port::kRightPixel, 0, false);
  EXPECT_NE(arbitration.state(1), none);
  arbitration.unroute(port::kRightPixel);
  arbitration.unroute(port::kLeftPixel);
  arbitration.route(port::kResult, 2, true);
  arbitration.arbitrate(1, kResult);
  EXPECT_NE(arbitration.state(2), none);
}

TEST(Arbitration, SharesABankFromItsFirstVisitToTheNextRoute) {
  Arbitration arbitration(kFixedPriority, banks());
  arbitration.route(port::kLeftPixel, 0, false);
  arbitration.route(port::kRightPixel, 1, false);
  EXPECT_FALSE(arbitration.is_shared(0));
  arbitration.visit(port::kHost, 0, true);
  EXPECT_TRUE(arbitration.is_shared(0));
  EXPECT_FALSE(arbitration.is_alone(port::kLeftPixel));
  EXPECT_FALSE(arbitration.is_shared(1));
  EXPECT_TRUE(arbitration.is_alone(port::kRightPixel));
  EXPECT_EQ(arbitration.visited(), 1U);
  arbitration.visit(port::kHost, 1, true);
  EXPECT_TRUE(arbitration.is_shared(0));
  EXPECT_TRUE(arbitration.is_shared(1));
  EXPECT_EQ(arbitration.visited(), 3U);
  arbitration.begin_recording();
  EXPECT_EQ(arbitration.arbitrate(0, kHost | kLeft | kRight), kHost | kLeft);
  arbitration.visit(port::kHost, 0, false);
  EXPECT_EQ(arbitration.bank_of(port::kHost), 0U);
  EXPECT_FALSE(arbitration.writes(port::kHost));
  EXPECT_EQ(arbitration.arbitrate(1, kHost | kLeft | kRight), kHost | kRight);
  EXPECT_EQ(arbitration.take_recorded().shared.size(), 4U);
  arbitration.unroute(port::kHost);
  EXPECT_EQ(arbitration.visited(), 0U);
  EXPECT_FALSE(arbitration.is_shared(0));
  EXPECT_TRUE(arbitration.is_alone(port::kLeftPixel));
  arbitration.visit(port::kHost, 0, true);
  arbitration.route(port::kRightPixel, 2, false);
  EXPECT_EQ(arbitration.visited(), 0U);
}

// Banks that no other port uses.
TEST(Arbitration, ForgetsAVisitedBankThatHasNoPortMoreWhenAnotherIsVisitedFirst) {
  Arbitration arbitration(kFixedPriority, banks());
  arbitration.visit(port::kHost, 0, true);
  arbitration.visit(port::kHost, 4, true);
  EXPECT_EQ(arbitration.visited(), 16U);
  EXPECT_FALSE(arbitration.is_shared(0));
}

TEST(Arbitration, KnowsWhichOtherPortsAreRoutedToABankAndWhetherItHasTurnaround) {
  Arbitration arbitration(kFixedPriority, banks());
  arbitration.route(port::kHost, 1, false);
  EXPECT_FALSE(arbitration.is_used_beside(port::kHost, 1));
  EXPECT_TRUE(arbitration.is_used_beside(port::kResult, 1));
  arbitration.route(port::kLeftPixel, 1, false);
  EXPECT_TRUE(arbitration.is_used_beside(port::kHost, 1));
  EXPECT_FALSE(arbitration.is_used_beside(port::kHost, 0));
  arbitration.unroute(port::kLeftPixel);
  EXPECT_FALSE(arbitration.is_used_beside(port::kHost, 1));
  for (std::size_t bank = 0; bank < kBanks; ++bank)
    EXPECT_EQ(arbitration.needs_turnaround(bank), bank == 2 || bank == 3);
}

// A read of a bank with separate ports waits for the read that is granted, not for the write beside it.
TEST(Arbitration, BlamesAPortOfTheSameDirectionOfABankWithSeparatePorts) {
  for (const bool write : {false, true}) {
    Arbitration arbitration({"fixed_priority", {0, 1, 2}}, {{16, BankKind::kQdr}});
    arbitration.route(0, 0, !write);
    arbitration.route(1, 0, write);
    arbitration.route(2, 0, write);
    const PortMask granted = arbitration.arbitrate(0, mask_of(0) | mask_of(1) | mask_of(2));
    EXPECT_EQ(granted, mask_of(0) | mask_of(1));
    EXPECT_EQ(arbitration.cause_of(2, granted), 1U);
  }
}

TEST(Arbitration, RoutesNoPortThatIsNotInThePriorityListAndNoneToABankThatDoesNotExist) {
  Arbitration arbitration({"fixed_priority", {1, 0}}, {{16}, {16}, {16}});
  const auto refusal = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "none";
  };
  const std::string no_port = "port = 2: must be 0..1";
  const std::string no_bank = "bank = 9: must be 0..2";
  EXPECT_EQ(refusal([&] { arbitration.route(2, 0, false); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.visit(2, 0, false); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.unroute(2); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.route(0, 9, false); }), no_bank);
  EXPECT_EQ(refusal([&] { arbitration.visit(0, 9, false); }), no_bank);
  EXPECT_EQ(refusal([&] { arbitration.route(1, 2, true); }), "none");
}

TEST(Arbitration, GrantsNothingToAPortThatIsUnrouted) {
  Arbitration arbitration(kFixedPriority, banks());
  arbitration.route(port::kLeftPixel, 0, false);
  arbitration.route(port::kRightPixel, 0, false);
  arbitration.unroute(port::kLeftPixel);
  EXPECT_EQ(arbitration.arbitrate(0, kLeft | kRight), kRight);
}

// Runs of requests for a bank that no port is routed to: a run without turnaround is decided in its first two
// cycles, and counted later.
TEST(Arbitration, DecidesAndCountsUnroutedAsRouted) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SplitMix64 random(seed);
    const ArbiterConfig config = random_arbiter(random);
    const auto bank = static_cast<std::size_t>(random.between(0, kBanks - 1));
    Arbitration unrouted(config, banks());
    Arbitration routed(config, banks());
    unrouted.begin_counting(0);
    routed.begin_counting(0);
    struct Run {
      std::uint64_t cycle;
      std::uint64_t cycles;
      BankArbiter::Outcome outcome;
    };
    std::vector<Run> runs;
    std::uint64_t cycle = 0;
    const auto decide = [&](bool write, std::uint64_t cycles) {
      const auto outcome = unrouted.decide_unrouted(bank, cycle, port::kHost, write);
      runs.push_back({cycle, cycles, outcome});
      for (; cycles > 0; --cycles)
        ASSERT_EQ(unrouted.grants(bank, outcome), routed.arbitrate(cycle++, kHost) == kHost);
    };
    for (int requests = 0; requests < 100; ++requests) {
      cycle += static_cast<std::uint64_t>(random.mostly_small(0, 2, 19));
      const bool write = random.chance(50);
      routed.route(port::kHost, bank, write);
      decide(write, 1);
      if (!unrouted.needs_turnaround(bank)) decide(write, static_cast<std::uint64_t>(random.between(1, 5)));
    }
    for (const Run& run : runs) unrouted.count_unrouted(bank, run.cycle, run.outcome, run.cycles);
    unrouted.end_counting(cycle + 5);
    routed.end_counting(cycle + 5);
    ASSERT_EQ(texts_of(unrouted.arbiters()), texts_of(routed.arbiters()));
  }
}

}  // namespace
}  // namespace stereotlm::memory
