#include <gtest/gtest.h>

#include "tests/unit/pci/pci_bus_bench.h"

// One master and one target: the clocks of a burst.
namespace stereotlm::pci {
namespace {

constexpr int kWait = 4;

TEST(PciBus, TransfersAWordAClockAfterAddressAndWaitClocks) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(5)};
  bench.request_at(bench.edge(10));
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 1U);
  const auto& burst = master.ended[0];
  EXPECT_EQ(burst.address_ps, bench.edge(10));
  EXPECT_EQ(burst.granted_ps, bench.edge(10));
  EXPECT_EQ(burst.result.end, BurstEnd::kComplete);
  EXPECT_EQ(burst.result.words, 5U);
  EXPECT_EQ(burst.result.first_data_clock, 10U + kWait + 1);
  EXPECT_EQ(burst.end_ps, bench.edge(10 + kWait + 1 + 5));
}

TEST(PciBus, WritesItsTargetOnceAtTheEndOfTheBurst) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  bench.masters[0]->bursts = {write_of(5, 0x40)};
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(bench.targets[0]->accesses.size(), 1U);
  const auto& access = bench.targets[0]->accesses[0];
  EXPECT_TRUE(access.write);
  EXPECT_EQ(access.address, 0x40U);
  EXPECT_EQ(access.words, words_from(PciBusBench::kBase + 0x40, 5));
  EXPECT_EQ(access.at_ps, bench.edge(1 + kWait + 5));
}

TEST(PciBus, ReadsItsTargetOnceInTheAddressClock) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  TestMaster& master = *bench.masters[0];
  master.bursts = {read_of(5, 0x40)};
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(bench.targets[0]->accesses.size(), 1U);
  const auto& access = bench.targets[0]->accesses[0];
  EXPECT_FALSE(access.write);
  EXPECT_EQ(access.address, 0x40U);
  EXPECT_EQ(access.at_ps, bench.edge(1));
  ASSERT_EQ(master.ended.size(), 1U);
  EXPECT_EQ(master.ended[0].words, words_from(0x40, 5));
  EXPECT_EQ(master.ended[0].result.first_data_clock, 1U + kWait);
  EXPECT_EQ(master.ended[0].end_ps, bench.edge(1 + kWait + 5));
}

TEST(PciBus, BeginsWithTheFirstClockThatBeginsAtOrAfterTheRequest) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  master.at_once = false;
  master.bursts = {write_of(1), write_of(1), write_of(1)};
  bench.request_at(bench.edge(100) - 1);
  bench.request_at(bench.edge(200));
  bench.request_at(bench.edge(300) + 1);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 3U);
  EXPECT_EQ(master.ended[0].address_ps, bench.edge(100));
  EXPECT_EQ(master.ended[1].address_ps, bench.edge(200));
  EXPECT_EQ(master.ended[2].address_ps, bench.edge(301));
}

TEST(PciBus, LeavesOneIdleClockBetweenBursts) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(7), write_of(3), read_of(2), write_of(1)};
  bench.request_at(0);
  sc_core::sc_start();
  std::vector<std::uint64_t> expected;
  std::uint64_t clock = 0;
  for (const std::size_t words : {7U, 3U, 2U, 1U}) {
    expected.push_back(bench.edge(clock));
    clock += 1 + kWait + words + 1;
  }
  std::vector<std::uint64_t> found;
  for (const auto& burst : master.ended) found.push_back(burst.address_ps);
  EXPECT_EQ(found, expected);
}

TEST(PciBus, TakesARequestInTheIdleClockForTheNextClock) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  master.at_once = false;
  master.bursts = {write_of(4), write_of(4), write_of(4)};
  bench.request_at(0);                   // idle clock: 5
  bench.request_at(bench.edge(6));       // not before the clock after it; idle clock 11
  bench.request_at(bench.edge(12) + 1);  // too late for that
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 3U);
  EXPECT_EQ(master.ended[1].address_ps, bench.edge(6));
  EXPECT_EQ(master.ended[2].address_ps, bench.edge(13));
}

TEST(PciBus, IgnoresARepeatedRequest) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  bench.request_at(bench.edge(3) - 2);
  bench.request_at(bench.edge(3) - 1);
  bench.at(
      bench.edge(3), [&master] { master.request(); }, 5);
  master.bursts = {write_of(1), write_of(1)};
  master.at_once = false;
  sc_core::sc_start();
  EXPECT_EQ(master.ended.size(), 1U);
}

struct Rate {
  int wait_clocks;
  double megabytes_per_second;  // of 32-word bursts: 4 * 32 * 33.33 / (32 + k), k = wait_clocks + 2
};

class PciBusRate : public testing::TestWithParam<Rate> {};

TEST_P(PciBusRate, IsThatOfTheBusWithinOnePercent) {
  constexpr std::size_t kBursts = 1000;
  constexpr std::size_t kWords = 32;
  PciBusBench bench(PciBusBench::with_window(GetParam().wait_clocks, 64));
  TestMaster& master = *bench.masters[0];
  for (std::size_t i = 0; i < kBursts; ++i)
    master.bursts.push_back(i % 2 == 0 ? write_of(kWords) : read_of(kWords));
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(master.words_done(), kBursts * kWords);
  const auto clocks = kBursts * (kWords + 2 + static_cast<std::size_t>(GetParam().wait_clocks)) - 1;
  EXPECT_EQ(master.ended.back().end_ps, bench.edge(clocks));
  const double seconds = sc_core::sc_time_stamp().to_seconds();
  const double rate = 4.0 * kBursts * kWords / seconds / 1e6;
  EXPECT_NEAR(rate, GetParam().megabytes_per_second, 0.01 * GetParam().megabytes_per_second);
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusRate,
                         testing::Values(Rate{1, 122}, Rate{3, 115}, Rate{6, 107}, Rate{14, 89}),
                         [](const auto& rate) {
                           return std::to_string(rate.param.wait_clocks) + "_wait_clocks";
                         });

TEST(PciBus, CountsClocksAndWordsUpToNow) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(5)};
  bench.request_at(bench.edge(10));
  const auto expect_at = [&bench](std::uint64_t time_ps, std::uint64_t clocks, std::uint64_t busy) {
    bench.at(time_ps, [&bench, clocks, busy] {
      const auto stats = bench.bus->stats();
      EXPECT_EQ(stats.clocks, clocks);
      EXPECT_EQ(stats.busy_clocks, busy) << "at clock " << clocks;
    });
  };
  constexpr std::uint64_t kEnd = 10 + 1 + kWait + 5;
  expect_at(bench.edge(10), 10, 0);
  expect_at(bench.edge(12) - 1, 11, 1);
  expect_at(bench.edge(12), 12, 2);
  expect_at(bench.edge(kEnd) - 1, kEnd - 1, kWait + 5);
  expect_at(bench.edge(kEnd), kEnd, 1 + kWait + 5);
  expect_at(bench.edge(kEnd + 30), kEnd + 30, 1 + kWait + 5);
  sc_core::sc_start();
  const auto stats = bench.bus->stats();
  ASSERT_EQ(stats.masters.size(), 1U);
  EXPECT_EQ(stats.masters[0].name, "m0");
  EXPECT_EQ(stats.masters[0].transactions, 1U);
  EXPECT_EQ(stats.masters[0].words, 5U);
  EXPECT_EQ(stats.masters[0].wait_clocks, 0U);
  EXPECT_EQ(stats.masters[0].retries, 0U);
  EXPECT_EQ(stats.masters[0].aborts, 0U);
}

TEST(PciBus, DoesNotDrift) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(1), write_of(1)};
  master.at_once = false;
  constexpr std::uint64_t kFar = 3'333'300'000;  // 100 s
  bench.request_at(0);
  bench.request_at(bench.edge(kFar));
  sc_core::sc_start();
  EXPECT_EQ(master.ended[1].address_ps, 100'000'000'000'000U);
  EXPECT_EQ(master.ended[1].result.first_data_clock, kFar + 1);
}

}  // namespace
}  // namespace stereotlm::pci
