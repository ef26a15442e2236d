// The latency timer cuts a burst with the first word in its clock or later, if another master waits.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::size_t kWords = 100;

// A burst of master 0 from clock 0 on, and a request of master 1.
struct Cut {
  const char* name;
  Script script = write_of(kWords);
  int wait_clocks = 3;
  int timer = 20;
  std::uint64_t request_clock = 0;
  std::uint64_t request_offset_ps = 0;
  int request_deltas = 0;
  std::uint64_t last_clock = 20;  // expected clock of the burst's last word
};
void PrintTo(const Cut& cut, std::ostream* out) { *out << cut.name; }

Cut request_in(const char* name, std::uint64_t clock, std::uint64_t last_clock) {
  Cut cut{name};
  cut.request_clock = clock;
  cut.last_clock = last_clock;
  return cut;
}
Cut request_a_ps_late() {
  Cut cut = request_in("asked_a_ps_behind_its_edge", 20, 21);
  cut.request_offset_ps = 1;
  return cut;
}
Cut request_in_a_later_delta() {
  Cut cut = request_in("asked_in_a_later_delta_at_its_edge", 20, 20);
  cut.request_deltas = 7;
  return cut;
}
Cut burst_of(const char* name, const Script& script, std::uint64_t last_clock = 20) {
  Cut cut{name, script};
  cut.last_clock = last_clock;
  return cut;
}

class PciBusLatencyTimer : public testing::TestWithParam<Cut> {};

TEST_P(PciBusLatencyTimer, CutsWithAWordInItsClockOrLaterIfAnotherMasterWaits) {
  const Cut& cut = GetParam();
  PciBusBench bench(PciBusBench::with_window(cut.wait_clocks, cut.timer), 2);
  bench.masters[0]->bursts = {cut.script};
  bench.masters[1]->bursts = {write_of(1)};
  bench.request_at(0, 0);
  bench.request_at(bench.edge(cut.request_clock) + cut.request_offset_ps, 1, cut.request_deltas);
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
    testing::Values(Cut{"another_waits"}, request_in("asked_a_clock_before", 19, 20),
                    request_in("asked_at_its_edge", 20, 20), request_in_a_later_delta(), request_a_ps_late(),
                    request_in("asked_later", 50, 50),
                    request_in("asked_in_the_clock_of_the_last_word", 3 + kWords, 3 + kWords),
                    request_in("asked_in_the_clock_of_the_last_word_but_one", 2 + kWords, 2 + kWords),
                    burst_of("read", read_of(kWords)), burst_of("burst_that_ends_with_it", write_of(17)),
                    burst_of("burst_of_one_more_word", write_of(18)),
                    Cut{"timer_within_the_wait_clocks", write_of(kWords), 9, 7, 0, 0, 0, 10},
                    Cut{"timer_0", write_of(kWords), 0, 0, 0, 0, 0, 1}),
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
