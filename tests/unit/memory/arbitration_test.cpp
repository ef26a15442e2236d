#include "models/memory/arbitration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/unit/memory/step_arbiter.h"

namespace stereotlm::memory {
namespace {

using test::SplitMix64;

constexpr PortMask kNone = 0;
constexpr int kBanks = 4;

constexpr PortMask both(PortMask a, PortMask b) { return static_cast<PortMask>(a | b); }
constexpr PortMask kLeft = mask_of(Port::kLeftPixel);
constexpr PortMask kRight = mask_of(Port::kRightPixel);
constexpr PortMask kResult = mask_of(Port::kResult);
constexpr PortMask kHost = mask_of(Port::kHost);

// Banks without turnaround, and two with.
std::vector<SsramBankConfig> banks() {
  return {
      {16}, {16, BankKind::kZbtFlowThrough}, {16, BankKind::kSyncBurst, 2}, {16, BankKind::kSyncBurst, 9}};
}

ArbiterConfig random_arbiter(SplitMix64& random) {
  ArbiterConfig config;
  if (random.chance(50)) config.policy = ArbitrationPolicy::kRoundRobin;
  for (std::size_t place = 0; place < kPortCount; ++place)
    std::swap(config.priority[place],
              config.priority[static_cast<std::size_t>(random.between(static_cast<int>(place), 5))]);
  return config;
}

std::string text_of(const BankArbiter& arbiter) {
  const ArbiterStats stats = arbiter.stats();
  std::ostringstream text;
  text << "reads " << stats.reads << ", writes " << stats.writes << ", turnaround " << stats.turnaround_cycles
       << ", idle " << stats.idle_cycles << ", contended " << stats.contended_cycles << ", uncounted "
       << arbiter.uncounted_accesses() << "; grants";
  for (const std::uint64_t grants : stats.grants) text << ' ' << grants;
  text << "; blame";
  for (const auto& row : stats.blame) {
    for (const std::uint64_t cycles : row) text << ' ' << cycles;
  }
  return text.str();
}

std::string text_of(const std::vector<BankArbiter>& arbiters) {
  std::string text;
  for (const BankArbiter& arbiter : arbiters) text += text_of(arbiter) + '\n';
  return text;
}

// An arbiter for each bank that is asked in every cycle.
class PlainArbitration {
 public:
  explicit PlainArbitration(const ArbiterConfig& config) {
    for (const SsramBankConfig& bank : banks()) arbiters.emplace_back(config, bank.turnaround_cycles);
  }
  void route(Port port, std::size_t bank, bool write) { routes[index_of(port)] = {bank, write}; }
  PortMask arbitrate(std::uint64_t cycle, PortMask requests) {
    PortMask granted = 0;
    for (std::size_t bank = 0; bank < arbiters.size(); ++bank) {
      PortMask asking = 0;
      PortMask writes = 0;
      for (std::size_t port = 0; port < kPortCount; ++port) {
        if ((requests >> port & 1U) == 0 || routes[port].first != bank) continue;
        asking = static_cast<PortMask>(asking | 1U << port);
        if (routes[port].second) writes = static_cast<PortMask>(writes | 1U << port);
      }
      if (asking != 0) granted = both(granted, memory::arbitrate(arbiters[bank], cycle, asking, writes));
    }
    return granted;
  }
  std::vector<BankArbiter> arbiters;
  std::array<std::pair<std::size_t, bool>, kPortCount> routes{};
};

// Every port gets a route, or most of them.
struct Routes {
  explicit Routes(SplitMix64& random) {
    for (std::size_t port = 0; port < kPortCount; ++port) {
      if (random.chance(10)) continue;
      const auto bank = static_cast<std::size_t>(random.between(0, kBanks - 1));
      routes[port] = {bank, random.chance(40)};
      ports = static_cast<PortMask>(ports | 1U << port);
    }
  }
  template <typename Target>
  void apply(Target& target) const {
    for (std::size_t port = 0; port < kPortCount; ++port) {
      if ((ports >> port & 1U) != 0)
        target.route(static_cast<Port>(port), routes[port].first, routes[port].second);
    }
  }
  std::array<std::pair<std::size_t, bool>, kPortCount> routes{};
  PortMask ports = 0;
};

PortMask random_requests(SplitMix64& random, PortMask ports) {
  return random.chance(20) ? kNone : static_cast<PortMask>(random.next() & ports);
}

TEST(Arbitration, GrantsAndCountsAsAnArbiterForEachBankWhoeverMeetsThere) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SplitMix64 random(seed);
    const ArbiterConfig config = random_arbiter(random);
    Arbitration arbitration(config, banks());
    PlainArbitration plain(config);
    std::uint64_t cycle = 0;
    for (int part = 0; part < 6; ++part) {
      for (std::size_t port = 0; port < kPortCount; ++port) arbitration.unroute(static_cast<Port>(port));
      const Routes routes(random);
      routes.apply(arbitration);
      routes.apply(plain);
      const bool counts = part % 2 == 1;
      if (counts) {
        arbitration.begin_counting(cycle);
        for (BankArbiter& arbiter : plain.arbiters) arbiter.begin_counting(cycle);
      }
      for (const std::uint64_t end = cycle + 100; cycle < end; ++cycle) {
        const PortMask requests = random_requests(random, routes.ports);
        ASSERT_EQ(arbitration.arbitrate(cycle, requests), plain.arbitrate(cycle, requests)) << cycle;
      }
      if (counts) {
        arbitration.end_counting(cycle);
        for (BankArbiter& arbiter : plain.arbiters) arbiter.end_counting(cycle);
      }
      ASSERT_EQ(text_of(arbitration.arbiters()), text_of(plain.arbiters)) << part;
    }
  }
}

// Two in the same routes, counting or not: one skips what the other steps.
struct TwoAlike {
  TwoAlike(SplitMix64& random, bool are_counted, std::uint64_t cycle)
      : config(random_arbiter(random)), routes(random), counts(are_counted) {
    for (Arbitration* arbitration : {&skips, &steps}) {
      routes.apply(*arbitration);
      if (counts) arbitration->begin_counting(cycle);
    }
  }
  // All that both have counted until then is the same.
  void expect_equal(std::uint64_t end_cycle) {
    for (Arbitration* arbitration : {&skips, &steps}) {
      if (counts) arbitration->end_counting(end_cycle);
    }
    ASSERT_EQ(text_of(skips.arbiters()), text_of(steps.arbiters()));
  }

  ArbiterConfig config;
  Routes routes;
  bool counts;
  Arbitration skips{config, banks()};
  Arbitration steps{config, banks()};
};

class ArbitrationPeriods : public testing::TestWithParam<bool> {};

TEST_P(ArbitrationPeriods, RepeatWhatSteppingThemAgainCounts) {
  int repeated = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SplitMix64 random(seed);
    std::uint64_t cycle = 7;
    TwoAlike two(random, GetParam(), cycle);
    std::vector<PortMask> period;
    for (int cycles = random.between(1, 30); cycles > 0; --cycles)
      period.push_back(random_requests(random, two.routes.ports));
    const auto step = [&](Arbitration& arbitration, std::uint64_t from) {
      for (std::size_t i = 0; i < period.size(); ++i) arbitration.arbitrate(from + i, period[i]);
    };
    // Until it comes back to where it was.
    for (int tries = 0; tries < 20; ++tries) {
      const Arbitration::State before = two.skips.state(cycle);
      two.skips.begin_recording();
      step(two.skips, cycle);
      step(two.steps, cycle);
      cycle += period.size();
      if (!(two.skips.state(cycle) == before)) continue;
      const auto times = static_cast<std::uint64_t>(random.between(1, 5));
      const Arbitration::Decided decided = two.skips.take_recorded();
      two.skips.count_skipped(decided, times);
      two.skips.skip_to(before, cycle + times * period.size(), times * period.size());
      for (std::uint64_t i = 0; i < times; ++i) step(two.steps, cycle + i * period.size());
      cycle += times * period.size();
      ++repeated;
      ASSERT_EQ(two.skips.state(cycle), two.steps.state(cycle));
    }
    for (const std::uint64_t end = cycle + 50; cycle < end; ++cycle) {
      const PortMask requests = random_requests(random, two.routes.ports);
      ASSERT_EQ(two.skips.arbitrate(cycle, requests), two.steps.arbitrate(cycle, requests));
    }
    ASSERT_NO_FATAL_FAILURE(two.expect_equal(cycle));
  }
  EXPECT_GT(repeated, 300);
}

// What one has recorded between two states another one skips, wherever in time it is in the first of them.
TEST_P(ArbitrationPeriods, SkipToWhereStepsLead) {
  int skipped = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SplitMix64 random(seed);
    std::uint64_t cycle = 3;
    TwoAlike two(random, GetParam(), cycle);
    struct Span {
      Arbitration::State begin;
      std::vector<PortMask> requests;
      Arbitration::Decided decided;
      Arbitration::State end;
    };
    std::vector<Span> spans;
    for (int part = 0; part < 60; ++part) {
      const Arbitration::State now = two.steps.state(cycle);
      ASSERT_EQ(two.skips.state(cycle), now);
      const auto known =
          std::find_if(spans.begin(), spans.end(), [&now](const Span& s) { return s.begin == now; });
      if (known != spans.end()) {
        const std::uint64_t cycles = known->requests.size();
        for (std::uint64_t i = 0; i < cycles; ++i) two.steps.arbitrate(cycle + i, known->requests[i]);
        cycle += cycles;
        two.skips.count_skipped(known->decided, 1);
        two.skips.skip_to(known->end, cycle, cycles);
        skipped += int{!(known->begin == known->end)};
        continue;
      }
      Span span{now, {}, {}, {}};
      for (int cycles = random.between(1, 12); cycles > 0; --cycles)
        span.requests.push_back(random_requests(random, two.routes.ports));
      two.skips.begin_recording();
      for (const PortMask requests : span.requests) {
        ASSERT_EQ(two.skips.arbitrate(cycle, requests), two.steps.arbitrate(cycle, requests));
        ++cycle;
      }
      span.decided = two.skips.take_recorded();
      span.end = two.steps.state(cycle);
      spans.push_back(span);
    }
    ASSERT_NO_FATAL_FAILURE(two.expect_equal(cycle));
  }
  EXPECT_GT(skipped, 100);
}

INSTANTIATE_TEST_SUITE_P(Arbitration, ArbitrationPeriods, testing::Bool(), [](const auto& suite) {
  return std::string(suite.param ? "Counted" : "NotCounted");
});

TEST(Arbitration, RepeatsAPeriodInWhichSomebodyAsksForTheArbiters) {
  Arbitration arbitration(ArbiterConfig{}, banks());
  arbitration.route(Port::kLeftPixel, 0, false);
  arbitration.begin_counting(0);
  for (std::uint64_t cycle = 0; cycle < 3; ++cycle) arbitration.arbitrate(cycle, kLeft);
  const Arbitration::State state = arbitration.state(3);
  arbitration.begin_recording();
  arbitration.arbitrate(3, kLeft);
  EXPECT_EQ(arbitration.arbiters()[0].stats().reads, 4U);
  arbitration.arbitrate(4, kLeft);
  arbitration.arbitrate(5, kNone);
  arbitration.count_skipped(arbitration.take_recorded(), 5);
  arbitration.skip_to(state, 21, 15);
  arbitration.end_counting(21);
  EXPECT_EQ(arbitration.arbiters()[0].stats().reads, 3U + 6 * 2);
  EXPECT_EQ(arbitration.arbiters()[0].stats().idle_cycles, 6U);
}

// Round robin: left_pixel is before right_pixel, unless it was the last that was granted.
PortMask granted_after_being_alone(std::uint64_t grants, std::uint64_t taken_back) {
  Arbitration arbitration({ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority}, banks());
  arbitration.route(Port::kLeftPixel, 0, false);
  for (std::uint64_t cycle = 0; cycle < grants; ++cycle) arbitration.arbitrate(cycle, kLeft);
  EXPECT_EQ(arbitration.arbiters()[0].uncounted_accesses(), grants);
  arbitration.retract_grants(Port::kLeftPixel, taken_back);
  EXPECT_EQ(arbitration.arbiters()[0].uncounted_accesses(), grants - taken_back);
  arbitration.route(Port::kRightPixel, 0, false);
  return arbitration.arbitrate(grants, both(kLeft, kRight));
}

TEST(Arbitration, MovesNoPlaceForGrantsThatAreTakenBackAfterSomebodyAsked) {
  EXPECT_EQ(granted_after_being_alone(0, 0), kLeft);
  EXPECT_EQ(granted_after_being_alone(5, 5), kLeft);
  EXPECT_EQ(granted_after_being_alone(5, 4), kRight);
  EXPECT_EQ(granted_after_being_alone(1, 0), kRight);
}

TEST(Arbitration, HasAStateOnlyWherePortsMeetOrTheBankTurnsRound) {
  Arbitration arbitration({ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority}, banks());
  const Arbitration::State none{};
  arbitration.route(Port::kLeftPixel, 0, false);
  arbitration.arbitrate(0, kLeft);
  EXPECT_EQ(arbitration.state(1), none);  // alone, its place is nobody's business
  arbitration.route(Port::kRightPixel, 0, false);
  EXPECT_NE(arbitration.state(1), none);
  arbitration.unroute(Port::kRightPixel);
  arbitration.unroute(Port::kLeftPixel);
  arbitration.route(Port::kResult, 2, true);
  arbitration.arbitrate(1, kResult);
  EXPECT_NE(arbitration.state(2), none);
}

TEST(Arbitration, HasTheSameStateWheneverItTurnsRoundForAsLong) {
  Arbitration arbitration(ArbiterConfig{}, banks());
  arbitration.route(Port::kResult, 2, true);
  arbitration.arbitrate(10, kResult);
  const Arbitration::State after_one = arbitration.state(11);
  EXPECT_NE(after_one, arbitration.state(12));
  EXPECT_EQ(arbitration.state(13), arbitration.state(14));  // ready
  arbitration.arbitrate(1000, kResult);
  EXPECT_EQ(arbitration.state(1001), after_one);
}

TEST(Arbitration, KnowsWhoElseIsRoutedToABank) {
  Arbitration arbitration(ArbiterConfig{}, banks());
  arbitration.route(Port::kHost, 1, false);
  EXPECT_FALSE(arbitration.is_used_beside(Port::kHost, 1));
  EXPECT_TRUE(arbitration.is_used_beside(Port::kResult, 1));
  arbitration.route(Port::kLeftPixel, 1, false);
  EXPECT_TRUE(arbitration.is_used_beside(Port::kHost, 1));
  EXPECT_FALSE(arbitration.is_used_beside(Port::kHost, 0));
  arbitration.unroute(Port::kLeftPixel);
  EXPECT_FALSE(arbitration.is_used_beside(Port::kHost, 1));
}

TEST(Arbitration, GrantsNothingToAPortThatIsUnrouted) {
  Arbitration arbitration(ArbiterConfig{}, banks());
  arbitration.route(Port::kLeftPixel, 0, false);
  arbitration.route(Port::kRightPixel, 0, false);
  arbitration.unroute(Port::kLeftPixel);
  EXPECT_EQ(arbitration.arbitrate(0, both(kLeft, kRight)), kRight);
}

// Requests for a bank that no port is routed to, decided now and counted later.
TEST(Arbitration, DecidesAndCountsUnroutedAsRouted) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SplitMix64 random(seed);
    const ArbiterConfig config = random_arbiter(random);
    const auto bank = static_cast<std::size_t>(random.between(0, kBanks - 1));
    Arbitration unrouted(config, banks());
    Arbitration routed(config, banks());
    unrouted.begin_counting(0);
    routed.begin_counting(0);
    std::vector<std::pair<std::uint64_t, BankArbiter::Outcome>> decided;
    std::uint64_t cycle = 0;
    for (int requests = 0; requests < 100; ++requests) {
      cycle += static_cast<std::uint64_t>(random.mostly_small(1, 3, 20));
      const bool write = random.chance(50);
      routed.route(Port::kHost, bank, write);
      const auto outcome = unrouted.decide_unrouted(bank, cycle, Port::kHost, write);
      decided.emplace_back(cycle, outcome);
      ASSERT_EQ(unrouted.grants(bank, outcome), routed.arbitrate(cycle, kHost) == kHost);
    }
    for (const auto& [at, outcome] : decided) unrouted.count_unrouted(bank, at, outcome, 1);
    unrouted.end_counting(cycle + 5);
    routed.end_counting(cycle + 5);
    ASSERT_EQ(text_of(unrouted.arbiters()), text_of(routed.arbiters()));
  }
}

TEST(Arbitration, KnowsWhichBanksNeedTurnaround) {
  const Arbitration arbitration(ArbiterConfig{}, banks());
  EXPECT_FALSE(arbitration.needs_turnaround(0));
  EXPECT_FALSE(arbitration.needs_turnaround(1));
  EXPECT_TRUE(arbitration.needs_turnaround(2));
}

}  // namespace
}  // namespace stereotlm::memory
