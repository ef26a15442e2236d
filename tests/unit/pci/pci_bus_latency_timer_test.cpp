#include <gtest/gtest.h>

#include "tests/unit/pci/pci_bus_bench.h"

// When the latency timer cuts a burst: with the first word in clock kTimer or later, if another master waits.
namespace stereotlm::pci {
namespace {

constexpr int kWait = 3;
constexpr int kTimer = 20;
constexpr std::size_t kWords = 100;

// Master 0 transfers from clock 0 on; master 1 may ask at some time.
class PciBusLatencyTimer : public testing::Test {
 protected:
  explicit PciBusLatencyTimer(int wait_clocks = kWait, int timer = kTimer)
      : bench(PciBusBench::with_window(wait_clocks, timer), 2) {
    first().bursts = {write_of(kWords)};
    second().bursts = {write_of(1)};
    bench.request_at(0, 0);
  }
  TestMaster& first() { return *bench.masters[0]; }
  TestMaster& second() { return *bench.masters[1]; }
  // The first burst ends with the word in this clock, and the second's address clock is two later.
  void expect_cut_in_clock(std::uint64_t clock, int wait_clocks = kWait) {
    ASSERT_EQ(first().ended.size(), 1U);
    ASSERT_EQ(second().ended.size(), 1U);
    EXPECT_EQ(first().ended[0].result.end, BurstEnd::kLatencyTimer);
    EXPECT_EQ(first().ended[0].result.words, clock - static_cast<std::uint64_t>(wait_clocks));
    EXPECT_EQ(first().ended[0].end_ps, bench.edge(clock + 1));
    EXPECT_EQ(second().ended[0].address_ps, bench.edge(clock + 2));
  }
  PciBusBench bench;
};

TEST_F(PciBusLatencyTimer, CutsInItsClockIfAnotherMasterWaitedBefore) {
  bench.request_at(0, 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
}

TEST_F(PciBusLatencyTimer, CutsInItsClockIfAnotherMasterAsksBefore) {
  bench.request_at(bench.edge(kTimer - 1), 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
}

TEST_F(PciBusLatencyTimer, CutsInItsClockIfAnotherMasterAsksWhenThatBegins) {
  bench.request_at(bench.edge(kTimer), 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
}

TEST_F(PciBusLatencyTimer, CutsInItsClockIfAnotherMasterAsksInALaterDeltaOfThatTime) {
  bench.at(
      bench.edge(kTimer), [this] { second().request(); }, 7);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
}

TEST_F(PciBusLatencyTimer, CutsAClockLaterIfAnotherMasterAsksAPicosecondTooLate) {
  bench.request_at(bench.edge(kTimer) + 1, 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer + 1);
}

TEST_F(PciBusLatencyTimer, CutsInTheClockThatBeginsWithALaterRequest) {
  bench.request_at(bench.edge(kTimer + 30), 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer + 30);
}

TEST_F(PciBusLatencyTimer, CutsByTheEarliestOfTwoRequests) {
  bench.request_at(bench.edge(kTimer + 10), 1);
  bench.at(bench.edge(kTimer + 20), [this] { second().request(); });
  sc_core::sc_start();
  expect_cut_in_clock(kTimer + 10);
}

TEST_F(PciBusLatencyTimer, LeavesABurstAloneThatNobodyWaitsFor) {
  sc_core::sc_start();
  EXPECT_EQ(first().ended[0].result.end, BurstEnd::kComplete);
  EXPECT_EQ(first().ended[0].result.words, kWords);
}

TEST_F(PciBusLatencyTimer, LeavesABurstAloneWhoseOwnMasterAsksAgain) {
  first().bursts.push_back(write_of(1));
  first().at_once = false;
  bench.request_at(bench.edge(5), 0);
  sc_core::sc_start();
  ASSERT_EQ(first().ended.size(), 2U);
  EXPECT_EQ(first().ended[0].result.end, BurstEnd::kComplete);
  EXPECT_EQ(first().ended[0].result.words, kWords);
}

TEST_F(PciBusLatencyTimer, CompletesWithARequestForTheClockOfTheLastWord) {
  constexpr std::uint64_t kLast = kWait + kWords;
  bench.request_at(bench.edge(kLast), 1);
  sc_core::sc_start();
  EXPECT_EQ(first().ended[0].result.end, BurstEnd::kComplete);
  EXPECT_EQ(first().ended[0].end_ps, bench.edge(kLast + 1));
}

TEST_F(PciBusLatencyTimer, TakesTheLastWordButOneAwayWithARequestForItsClock) {
  bench.request_at(bench.edge(kWait + kWords - 1), 1);
  sc_core::sc_start();
  expect_cut_in_clock(kWait + kWords - 1);
}

TEST_F(PciBusLatencyTimer, CutsAReadAndHandsOverTheWordsTransferredOnly) {
  first().bursts = {read_of(kWords)};
  bench.request_at(bench.edge(1), 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
  auto expected = words_from(0, kTimer - kWait);
  expected.resize(kWords);
  EXPECT_EQ(first().ended[0].words, expected);
}

TEST_F(PciBusLatencyTimer, HandsTheTargetTheWordsTransferredOnly) {
  bench.request_at(0, 1);
  sc_core::sc_start();
  EXPECT_EQ(bench.targets[0]->accesses[0].words, words_from(PciBusBench::kBase, kTimer - kWait));
}

// N words end in clock kWait + N.
class PciBusLatencyTimerLength : public PciBusLatencyTimer {};

TEST_F(PciBusLatencyTimerLength, CompletesABurstThatEndsInTheClockOfTheTimer) {
  first().bursts = {write_of(kTimer - kWait)};
  bench.request_at(0, 1);
  sc_core::sc_start();
  EXPECT_EQ(first().ended[0].result.end, BurstEnd::kComplete);
}

TEST_F(PciBusLatencyTimerLength, CutsABurstThatIsAWordLonger) {
  first().bursts = {write_of(kTimer - kWait + 1)};
  bench.request_at(0, 1);
  sc_core::sc_start();
  expect_cut_in_clock(kTimer);
}

// The timer of a target that waits longer than it.
class PciBusShortLatencyTimer : public PciBusLatencyTimer {
 protected:
  static constexpr int kLongWait = 9;
  PciBusShortLatencyTimer() : PciBusLatencyTimer(kLongWait, kLongWait - 2) {}
};

TEST_F(PciBusShortLatencyTimer, AlwaysLetsOneWordThrough) {
  bench.request_at(0, 1);
  sc_core::sc_start();
  expect_cut_in_clock(kLongWait + 1, kLongWait);
}

class PciBusNoLatencyTimer : public PciBusLatencyTimer {
 protected:
  PciBusNoLatencyTimer() : PciBusLatencyTimer(0, 0) {}
};

TEST_F(PciBusNoLatencyTimer, LetsOneWordThroughAtATime) {
  bench.request_at(0, 1);
  sc_core::sc_start();
  expect_cut_in_clock(1, 0);
}

}  // namespace
}  // namespace stereotlm::pci
