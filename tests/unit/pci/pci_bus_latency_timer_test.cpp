// The latency timer cuts a burst with the first word in its clock or later, if another master waits. The
// random boards of pci_bus_random_test.cpp have other timers, wait clocks and lengths.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::size_t kWords = 100;

// A burst of master 0 from clock 0 on, and a request of master 1 at a clock's edge, or some ps or deltas
// later.
struct Cut {
  const char* name;
  std::uint64_t clock;
  std::uint64_t offset_ps;
  int deltas;
  std::uint64_t last_clock;  // expected clock of the burst's last word
  bool write = true;
};
void PrintTo(const Cut& cut, std::ostream* out) { *out << cut.name; }

class PciBusLatencyTimer : public testing::TestWithParam<Cut> {};

TEST_P(PciBusLatencyTimer, CutsWithAWordInItsClockOrLaterIfAnotherMasterWaits) {
  const Cut& cut = GetParam();
  PciBusBench bench(PciBusBench::with_window(kWait, 20), 2);
  bench.masters[0]->bursts = {{cut.write, PciBusBench::kBase, kWords}};
  bench.masters[1]->bursts = {write_of(1)};
  bench.request_at(0, 0);
  bench.request_at(bench.edge(cut.clock) + cut.offset_ps, 1, cut.deltas);
  sc_core::sc_start();
  ASSERT_EQ(bench.masters[0]->ended.size(), 1U);
  ASSERT_EQ(bench.masters[1]->ended.size(), 1U);
  const auto& burst = bench.masters[0]->ended[0];
  const std::size_t words = cut.last_clock - kWait;
  EXPECT_EQ(burst.result.end, BurstEnd::kLatencyTimer);
  EXPECT_EQ(burst.result.words, words);
  EXPECT_EQ(burst.end_ps, bench.edge(cut.last_clock + 1));
  EXPECT_EQ(bench.masters[1]->ended[0].address_ps, bench.edge(cut.last_clock + 2));
  if (cut.write) {
    EXPECT_EQ(bench.targets[0]->accesses[0].words, words_from(PciBusBench::kBase, words));
  } else {
    auto expected = words_from(0, words);
    expected.resize(kWords);
    EXPECT_EQ(burst.words, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusLatencyTimer,
                         testing::Values(Cut{"another_waits", 0, 0, 0, 20}, Cut{"read", 0, 0, 0, 20, false},
                                         Cut{"asked_in_a_later_delta", 20, 0, 7, 20},
                                         Cut{"asked_a_ps_behind_its_edge", 20, 1, 0, 21}),
                         [](const auto& tested) { return tested.param.name; });

// Data clocks 5..20: 32 words. A burst of 31 or 32 words ends there by itself, and one of 33 is cut.
TEST(PciBus, CutsWithTheTwoWordsOfAClockOn64Bits) {
  PciBusConfig config = PciBusBench::with_window(kWait, 20);
  config.width_bits = 64;
  PciBusBench bench(config, 2);
  TestMaster& master = *bench.masters[0];
  master.at_once = false;
  for (const std::size_t words : {31, 32, 33, 100}) {
    master.bursts.push_back({true, PciBusBench::kBase, words});
    bench.masters[1]->bursts.push_back(write_of(1));
  }
  bench.masters[1]->at_once = false;
  bench.masters[1]->on_end = [&] {
    if (master.bursts.empty()) return;
    master.request();
    bench.masters[1]->request();
  };
  bench.request_at(0, 0);
  bench.request_at(0, 1);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 4U);
  const std::size_t transferred[] = {31, 32, 32, 32};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& burst = master.ended[i];
    EXPECT_EQ(burst.result.words, transferred[i]);
    EXPECT_EQ(burst.result.end, i < 2 ? BurstEnd::kComplete : BurstEnd::kLatencyTimer);
    EXPECT_EQ(bench.bus->clock().edge_at_or_after(burst.end_ps) -
                  bench.bus->clock().edge_at_or_after(burst.address_ps),
              21U);
  }
}

TEST(PciBus, DoesNotCutABurstWhoseOwnMasterAloneRequestsAgain) {
  PciBusBench bench(PciBusBench::with_window(3, 20));
  bench.masters[0]->bursts = {write_of(kWords), write_of(1)};
  bench.masters[0]->at_once = false;
  bench.request_at(0);
  bench.request_at(bench.edge(5));
  sc_core::sc_start();
  ASSERT_EQ(bench.masters[0]->ended.size(), 2U);
  EXPECT_EQ(bench.masters[0]->ended[0].result.end, BurstEnd::kComplete);
  EXPECT_EQ(bench.masters[0]->ended[0].result.words, kWords);
}

}  // namespace
}  // namespace stereotlm::pci
