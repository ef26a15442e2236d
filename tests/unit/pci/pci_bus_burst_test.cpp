// The clocks of a burst with one master and one target.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr int kWait = 4;

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

// Requests of bursts of `words` words, at a clock's edge and some ps.
struct RequestTimes {
  const char* name;
  std::size_t words;
  std::vector<std::pair<std::uint64_t, int>> requests;
  std::vector<std::uint64_t> address_clocks;
};
void PrintTo(const RequestTimes& times, std::ostream* out) { *out << times.name; }

class PciBusRequest : public testing::TestWithParam<RequestTimes> {};

TEST_P(PciBusRequest, IsGrantedTheFirstClockThatBeginsAtOrAfterIt) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  master.at_once = false;
  master.bursts.assign(8, write_of(GetParam().words));
  for (const auto& [clock, offset_ps] : GetParam().requests)
    bench.request_at(bench.edge(clock) + static_cast<std::uint64_t>(offset_ps));
  sc_core::sc_start();
  std::vector<std::uint64_t> found;
  for (const auto& burst : master.ended) found.push_back(burst.address_ps);
  std::vector<std::uint64_t> expected;
  for (const std::uint64_t clock : GetParam().address_clocks) expected.push_back(bench.edge(clock));
  EXPECT_EQ(found, expected);
}

// The idle clock of a burst of 4 words that begins in clock 0 is clock 5.
INSTANTIATE_TEST_SUITE_P(
    PciBus, PciBusRequest,
    testing::Values(RequestTimes{"around_an_edge", 1, {{100, -1}, {200, 0}, {300, 1}}, {100, 200, 301}},
                    RequestTimes{"in_the_idle_clock", 4, {{0, 0}, {5, 0}, {12, 1}}, {0, 6, 13}},
                    RequestTimes{"behind_the_idle_clock", 4, {{0, 0}, {6, 0}}, {0, 6}},
                    RequestTimes{"repeated", 1, {{3, -2}, {3, -1}, {3, 0}}, {3}}),
    [](const auto& tested) { return tested.param.name; });

struct Rate {
  int wait_clocks;
  double megabytes_per_second;  // of 32-word bursts: 4 * 32 * 33.33 / (32 + k), k = wait_clocks + 2
};

class PciBusRate : public testing::TestWithParam<Rate> {};

TEST_P(PciBusRate, IsWithinOnePercentOfARealBus) {
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
  ASSERT_EQ(stats.masters.size(), 1U);
  EXPECT_EQ(stats.masters[0].name, "m0");
  EXPECT_EQ(stats.masters[0].transactions, 1U);
  EXPECT_EQ(stats.masters[0].words, 5U);
  EXPECT_EQ(stats.masters[0].wait_clocks, 0U);
  EXPECT_EQ(stats.masters[0].retries, 0U);
  EXPECT_EQ(stats.masters[0].aborts, 0U);
}

}  // namespace
}  // namespace stereotlm::pci
