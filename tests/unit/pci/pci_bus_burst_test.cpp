// The clocks of a burst with one master and one target.
#include <gtest/gtest.h>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

class PciBusBurst : public testing::TestWithParam<bool> {};

TEST_P(PciBusBurst, TransfersAWordAClockAfterAddressAndWaitClocks) {
  const bool write = GetParam();
  constexpr std::uint64_t kFirst = 10 + 1 + kWait;
  PciBusBench bench(PciBusBench::with_window(kWait));
  TestMaster& master = *bench.masters[0];
  master.bursts = {{write, PciBusBench::kBase + 0x40, 5}};
  bench.request_at(bench.edge(10));
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 1U);
  const auto& burst = master.ended[0];
  EXPECT_EQ(burst.address_ps, bench.edge(10));
  EXPECT_EQ(burst.granted_ps, bench.edge(10));
  EXPECT_EQ(burst.result.end, BurstEnd::kComplete);
  EXPECT_EQ(burst.result.words, 5U);
  EXPECT_EQ(burst.result.first_data_clock, kFirst);
  EXPECT_EQ(burst.end_ps, bench.edge(kFirst + 5));
  ASSERT_EQ(bench.targets[0]->accesses.size(), 1U);
  const auto& access = bench.targets[0]->accesses[0];
  EXPECT_EQ(access.write, write);
  EXPECT_EQ(access.address, 0x40U);
  EXPECT_EQ(access.words, burst.words);
  EXPECT_EQ(burst.words, words_from(write ? PciBusBench::kBase + 0x40 : 0x40, 5));
  EXPECT_EQ(access.at_ps, bench.edge(write ? kFirst + 5 : 11));
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusBurst, testing::Bool(),
                         [](const auto& write) { return write.param ? "write" : "read"; });

// Windows in any order, up to the end of the address space, and the rate of a real bus with their wait
// clocks: bursts of 32 words, 33.33 MHz.
TEST(PciBus, ReachesEachWindowWithinOnePercentOfTheRateOfARealBus) {
  constexpr std::size_t kBursts = 1000;
  constexpr std::size_t kWords = 32;
  const std::vector<double> megabytes_per_second = {122, 115, 107, 89};
  PciBusConfig config;
  config.windows = {{0x8000, 0x1000, 1}, {0x1000, 0x1000, 3}, {0xFFFF'F000, 0x1000, 6}, {0x3000, 0x1000, 14}};
  PciBusBench bench(config);
  TestMaster& master = *bench.masters[0];
  for (const PciWindow& window : config.windows) {
    for (std::size_t i = 0; i < kBursts; ++i) master.bursts.push_back({i % 2 == 0, window.base + 8U, kWords});
  }
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), kBursts * config.windows.size());
  for (std::size_t window = 0; window < config.windows.size(); ++window) {
    ASSERT_EQ(bench.targets[window]->accesses.size(), kBursts);
    EXPECT_EQ(bench.targets[window]->accesses[0].address, 8U);
    const auto first_ps = master.ended[window * kBursts].address_ps;
    const auto end_ps = master.ended[(window + 1) * kBursts - 1].end_ps;
    const double rate = 4e6 * kBursts * kWords / static_cast<double>(end_ps - first_ps);
    EXPECT_NEAR(rate, megabytes_per_second[window], 0.01 * megabytes_per_second[window]);
  }
}

TEST(PciBus, CountsClocksAndWordsUpToNow) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  bench.masters[0]->bursts = {write_of(5)};
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
  EXPECT_EQ(stats.masters.at(0).name, "m0");
  EXPECT_EQ(stats.masters[0].words, 5U);
  EXPECT_EQ(stats.masters[0].retries, 0U);
  EXPECT_EQ(stats.masters[0].aborts, 0U);
}

}  // namespace
}  // namespace stereotlm::pci
