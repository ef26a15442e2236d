// The control of the local bus without its module and without the kernel.
#include "models/fpga/local_bus_control.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace stereotlm::fpga {
namespace {

constexpr std::size_t kBankCount = 2;

class LocalBusControlTest : public testing::Test, public LocalBusControl::Core, public LocalBusMasterIf {
 protected:
  static constexpr std::uint64_t kPs = 25'000;  // a clock

  LocalBusControlTest() { bus.bind(*this); }
  bool begin(std::uint64_t now_ps, std::uint64_t address, std::size_t count, bool write = true) {
    words.resize(count);
    return bus.begin_burst(now_ps,
                           {write, address, reinterpret_cast<unsigned char*>(words.data()), words.size()});
  }

  void route(const HostRoute& to) override { routes.push_back(to); }
  bool access_bank(std::uint64_t, bool, std::uint64_t, std::uint32_t&) override { return true; }
  bool access_register(std::uint64_t now_ps, bool, std::uint64_t address, std::uint32_t& word) override {
    register_accesses_ps.push_back(now_ps);
    word = static_cast<std::uint32_t>(address);
    return true;
  }
  void end_burst_at(std::uint64_t end_ps, bool ok) override {
    ends_ps.push_back(end_ps);
    oks.push_back(ok);
  }

  LocalBusControl bus{{40, {}}, kBankCount, *this};
  std::vector<std::uint32_t> words;
  std::vector<HostRoute> routes;
  std::vector<std::uint64_t> register_accesses_ps;
  std::vector<std::uint64_t> ends_ps;
  std::vector<bool> oks;
};

TEST_F(LocalBusControlTest, RefusesABurstWithoutBeginningIt) {
  EXPECT_FALSE(begin(0, 2, 1));
  EXPECT_FALSE(begin(0, std::uint64_t{kBankCount} << 28U, 1));
  EXPECT_FALSE(begin(0, (1U << 28U) - 4, 2));
  EXPECT_EQ(bus.stats(0).errors, 3U);
  EXPECT_EQ(bus.stats(0).bursts, 0U);
  EXPECT_TRUE(routes.empty());
  EXPECT_TRUE(ends_ps.empty());
  EXPECT_TRUE(begin(0, (1U << 28U) - 4, 1));
}

TEST_F(LocalBusControlTest, StepsOnlyForRegistersAtTheEndOfEachWordsClock) {
  EXPECT_TRUE(begin(0, 0, 2));
  EXPECT_EQ(bus.next_ps(), kNever);
  bus.count_granted(2, 4 * kPs, 6 * kPs);
  EXPECT_EQ(ends_ps, (std::vector<std::uint64_t>{5 * kPs}));  // the idle clock is 4
  EXPECT_TRUE(begin(5 * kPs, kLocalRegisters + 8, 2, false));
  for (const std::uint64_t edge : {8U, 9U}) {  // behind address clock 5 and decode clock 6
    EXPECT_EQ(bus.next_ps(), edge * kPs);
    EXPECT_EQ(ends_ps.size(), 1U);
    bus.step(edge * kPs);
  }
  EXPECT_EQ(bus.next_ps(), kNever);
  EXPECT_EQ(words, (std::vector<std::uint32_t>{8, 12}));
  EXPECT_EQ(register_accesses_ps, (std::vector<std::uint64_t>{8 * kPs, 9 * kPs}));
  EXPECT_EQ(ends_ps.back(), 10 * kPs);
  EXPECT_EQ(oks, (std::vector<bool>{true, true}));
}

// Bursts without a pause, and with pauses of 1 ps and more.
TEST_F(LocalBusControlTest, BeginsEachBurstWithTheFirstClockAtOrAfterItsTime) {
  std::mt19937_64 random(1);
  for (const double mhz : {40.0, 33.333, 66.667, 29.97}) {
    const Clock clock(mhz);
    LocalBusControl control({mhz, {}}, kBankCount, *this);
    control.bind(*this);
    std::uint64_t now_ps = 0;
    for (int burst = 0; burst < 1000; ++burst) {
      std::uint32_t word = 0;
      control.begin_burst(now_ps, {true, 0, reinterpret_cast<unsigned char*>(&word), 1});
      const std::uint64_t first = clock.edge_at_or_after(now_ps);
      ASSERT_EQ(control.request_ps(), clock.edge_ps(first + 3)) << mhz << " MHz at " << now_ps;
      const std::uint64_t grant_ps = control.request_ps() + random() % 40'000;
      control.access(grant_ps, grant_ps);
      now_ps = ends_ps.back();
      ASSERT_EQ(now_ps, clock.edge_ps(clock.edge_at_or_after(grant_ps) + 1)) << mhz << " MHz at " << grant_ps;
      now_ps += random() % 2 == 0 ? 0 : random() % 3 == 0 ? 1 : random() % 100'000;
    }
  }
}

// Two bursts of three words, which begin in clocks 10 and 20, are stepped or skipped.
TEST_F(LocalBusControlTest, IsInTheSameStateAfterBurstsThatAreSkipped) {
  LocalBusControl skipping({40, {{0, 64}}}, kBankCount, *this);
  LocalBusControl stepped({40, {{0, 64}}}, kBankCount, *this);
  const auto run = [&](LocalBusControl& control, std::uint64_t clock) {
    std::uint32_t data[3] = {};
    EXPECT_TRUE(control.begin_burst(clock * kPs, {true, 8, reinterpret_cast<unsigned char*>(data), 3}));
    control.count_granted(3, (clock + 5) * kPs, (clock + 7) * kPs);
  };
  for (LocalBusControl* control : {&skipping, &stepped}) {
    control->bind(*this);
    run(*control, 2);
  }
  const std::uint64_t busy = stepped.busy_clocks();
  for (const std::uint64_t clock : {10U, 20U}) run(stepped, clock);
  skipping.skip_bursts(2, stepped.busy_clocks() - busy, 25);
  skipping.count_words(true, 8, 6);
  EXPECT_EQ(stepped.busy_clocks() - busy, 2 * 5U);  // address, decode, three words
  for (const std::uint64_t clock : {30U, 31U}) {    // the idle clock is 25
    const LocalBusControl::Stats a = skipping.stats(clock * kPs);
    const LocalBusControl::Stats b = stepped.stats(clock * kPs);
    EXPECT_EQ(a.bursts, b.bursts);
    EXPECT_EQ(a.words_written, b.words_written);
    EXPECT_EQ(a.busy_clocks, b.busy_clocks);
    EXPECT_EQ(skipping.idle_clock(), stepped.idle_clock());
    EXPECT_EQ(skipping.words_granted().words(), stepped.words_granted().words());
    if (clock == 30) {  // the next burst
      run(skipping, 26);
      run(stepped, 26);
    }
  }
}

TEST_F(LocalBusControlTest, IsInStepWithAClockThatHasItsEdges) {
  EXPECT_TRUE(bus.is_in_step_with(Clock(40)));
  EXPECT_FALSE(bus.is_in_step_with(Clock(80)));
}

class LocalBusControlBursts : public LocalBusControlTest, public LocalBusObserver {
 protected:
  LocalBusControlBursts() { bus.observe(*this); }
  void local_burst_ended(const EndedLocalBurst& burst) override { bursts.push_back(burst); }
  void expect(std::size_t index, bool write, std::uint64_t address, std::uint64_t count, std::uint64_t first,
              std::uint64_t idle) {
    ASSERT_GT(bursts.size(), index);
    const EndedLocalBurst& burst = bursts[index];
    EXPECT_EQ(burst.write, write);
    EXPECT_EQ(burst.address, address);
    EXPECT_EQ(burst.words, count);
    EXPECT_EQ(burst.address_ps, first * kPs);
    EXPECT_EQ(burst.data_ps, (first + 1) * kPs);
    EXPECT_EQ(burst.end_ps, idle * kPs);
    EXPECT_EQ(burst.free_ps, (idle + 1) * kPs);
  }
  std::vector<EndedLocalBurst> bursts;
};

// The word of the read is usable two clocks after its grant. The refused burst is none.
TEST_F(LocalBusControlBursts, AreShownToAnObserverAsSoonAsTheirEndsAreKnown) {
  EXPECT_TRUE(begin(kPs - 1, 8, 2));
  EXPECT_TRUE(bursts.empty());
  bus.count_granted(2, 5 * kPs, 7 * kPs);
  expect(0, true, 8, 2, 1, 5);
  EXPECT_FALSE(begin(6 * kPs, 2, 1));
  EXPECT_TRUE(begin(10 * kPs, 64, 1, false));
  bus.access(13 * kPs, 15 * kPs);
  expect(1, false, 64, 1, 10, 15);
  EXPECT_TRUE(begin(20 * kPs, kLocalRegisters + 4, 1));
  bus.step(23 * kPs);
  expect(2, true, kLocalRegisters + 4, 1, 20, 23);
  EXPECT_EQ(bursts.size(), 3U);
}

}  // namespace
}  // namespace stereotlm::fpga
