// The latency timer cuts a burst with the first word in its clock or later, if another master waits.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::size_t kWords = 100;

struct RequestTime {
  std::uint64_t clock = 0;
  std::uint64_t offset_ps = 0;
  int deltas = 0;
};
// A burst of master 0 from clock 0 on, and a request of master 1.
struct Cut {
  const char* name;
  RequestTime request;
  std::uint64_t last_clock;  // expected clock of the burst's last word
  Script script = write_of(kWords);
  int wait_clocks = 3;
  int timer = 20;
};
void PrintTo(const Cut& cut, std::ostream* out) { *out << cut.name; }

class PciBusLatencyTimer : public testing::TestWithParam<Cut> {};

TEST_P(PciBusLatencyTimer, CutsWithAWordInItsClockOrLaterIfAnotherMasterWaits) {
  const Cut& cut = GetParam();
  PciBusBench bench(PciBusBench::with_window(cut.wait_clocks, cut.timer), 2);
  bench.masters[0]->bursts = {cut.script};
  bench.masters[1]->bursts = {write_of(1)};
  bench.request_at(0, 0);
  bench.request_at(bench.edge(cut.request.clock) + cut.request.offset_ps, 1, cut.request.deltas);
  sc_core::sc_start();
  ASSERT_EQ(bench.masters[0]->ended.size(), 1U);
  ASSERT_EQ(bench.masters[1]->ended.size(), 1U);
  const auto& burst = bench.masters[0]->ended[0];
  const std::size_t words = cut.last_clock - static_cast<std::uint64_t>(cut.wait_clocks);
  EXPECT_EQ(burst.result.end, words == cut.script.words ? BurstEnd::kComplete : BurstEnd::kLatencyTimer);
  EXPECT_EQ(burst.result.words, words);
  EXPECT_EQ(burst.end_ps, bench.edge(cut.last_clock + 1));
  EXPECT_EQ(bench.masters[1]->ended[0].address_ps, bench.edge(cut.last_clock + 2));
  if (cut.script.write) {
    EXPECT_EQ(bench.targets[0]->accesses[0].words, words_from(PciBusBench::kBase, words));
  } else {
    auto expected = words_from(0, words);
    expected.resize(kWords);
    EXPECT_EQ(burst.words, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(
    PciBus, PciBusLatencyTimer,
    testing::Values(Cut{"another_waits", {}, 20}, Cut{"asked_a_clock_before", {19}, 20},
                    Cut{"asked_at_its_edge", {20}, 20}, Cut{"asked_in_a_later_delta", {20, 0, 7}, 20},
                    Cut{"asked_a_ps_behind_its_edge", {20, 1}, 21}, Cut{"asked_later", {50}, 50},
                    Cut{"asked_in_the_clock_of_the_last_word", {3 + kWords}, 3 + kWords},
                    Cut{"asked_in_the_clock_of_the_last_word_but_one", {2 + kWords}, 2 + kWords},
                    Cut{"read", {}, 20, read_of(kWords)},
                    Cut{"burst_that_ends_with_it", {}, 20, write_of(17)},
                    Cut{"burst_of_one_more_word", {}, 20, write_of(18)},
                    Cut{"timer_within_the_wait_clocks", {}, 10, write_of(kWords), 9, 7},
                    Cut{"timer_0", {}, 1, write_of(kWords), 0, 0}),
    [](const auto& tested) { return tested.param.name; });

TEST(PciBus, CutsByTheEarliestOfTwoRequests) {
  PciBusBench bench(PciBusBench::with_window(3, 20), 3);
  bench.masters[0]->bursts = {write_of(kWords)};
  bench.request_at(0, 0);
  bench.at(bench.edge(5), [&bench] {
    for (const std::size_t master : {1U, 2U})
      bench.masters[master]->pci->request(*bench.masters[master], bench.edge(50 - 10 * master));
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.masters[0]->ended[0].end_ps, bench.edge(31));
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
