#include <gtest/gtest.h>

#include "tests/support/expected_report.h"
#include "tests/unit/pci/pci_bus_bench.h"

// What targets and addresses do to a burst.
namespace stereotlm::pci {
namespace {

constexpr int kWait = 4;

// One master, whose first burst begins in clock 0 and whose second follows at once.
class PciBusTarget : public testing::Test {
 protected:
  PciBusTarget()
      : bench(PciBusBench::with_window(kWait)), master(*bench.masters[0]), target(*bench.targets[0]) {}
  void simulate(const Script& script) {
    master.bursts = {script, write_of(1)};
    bench.request_at(0);
    sc_core::sc_start();
    ASSERT_EQ(master.ended.size(), 2U);
  }
  const TestMaster::Ended& burst() const { return master.ended[0]; }
  // The clock behind the burst is idle, and the next address clock follows.
  void expect_end_clock(std::uint64_t clock) const {
    EXPECT_EQ(burst().end_ps, bench.edge(clock));
    EXPECT_EQ(master.ended[1].address_ps, bench.edge(clock + 1));
  }
  void expect_nothing_transferred(BurstEnd end) const {
    EXPECT_EQ(burst().result.end, end);
    EXPECT_EQ(burst().result.words, 0U);
    EXPECT_EQ(bench.bus->stats().masters[0].words, 1U);
  }
  void expect_first_word_in(std::uint64_t clock) const {
    EXPECT_EQ(burst().result.end, BurstEnd::kComplete);
    EXPECT_EQ(burst().result.first_data_clock, clock);
    expect_end_clock(clock + burst().result.words);
  }
  // Of a read: from the end of the address clock on.
  sc_core::sc_time clocks(std::uint64_t count, int offset_ps) const {
    return Clock::to_time(bench.edge(1 + count) - bench.edge(1) + static_cast<std::uint64_t>(offset_ps));
  }

  PciBusBench bench;
  TestMaster& master;
  TestTarget& target;
};

TEST_F(PciBusTarget, DisconnectsAWriteAfterTheWordsThatItTakes) {
  bench.bind_stop();
  target.writable = [](auto, auto words) { return std::min<std::size_t>(words, 3); };
  simulate(write_of(8));
  EXPECT_EQ(burst().result.end, BurstEnd::kDisconnect);
  EXPECT_EQ(burst().result.words, 3U);
  EXPECT_EQ(target.accesses[0].words, words_from(PciBusBench::kBase, 3));
  expect_end_clock(1 + kWait + 3);
  EXPECT_EQ(bench.bus->stats().masters[0].retries, 0U);
}

TEST_F(PciBusTarget, CompletesAWriteThatItCanJustTake) {
  bench.bind_stop();
  std::vector<std::pair<std::uint64_t, std::size_t>> asked;
  target.writable = [&asked](auto address, auto words) {
    asked.emplace_back(address, words);
    return words;
  };
  simulate(write_of(8, 0x20));
  EXPECT_EQ(asked[0], std::make_pair(std::uint64_t{0x20}, std::size_t{8}));
  EXPECT_EQ(burst().result.end, BurstEnd::kComplete);
}

TEST_F(PciBusTarget, RetriesAWriteAfterItsAddressClock) {
  bench.bind_stop();
  bool full = true;
  target.writable = [&full](auto, auto words) { return std::exchange(full, false) ? 0U : words; };
  simulate(write_of(8));
  expect_nothing_transferred(BurstEnd::kDisconnect);
  expect_end_clock(1);
  EXPECT_EQ(target.accesses.size(), 1U);
  EXPECT_EQ(bench.bus->stats().masters[0].retries, 1U);
  EXPECT_EQ(bench.bus->stats().busy_clocks, 1U + 1 + kWait + 1);
}

TEST_F(PciBusTarget, AsksNoRoomForARead) {
  bench.bind_stop();
  target.writable = [](auto, auto words) {
    EXPECT_EQ(words, 1U);
    return words;
  };
  simulate(read_of(8));
  EXPECT_EQ(burst().result.words, 8U);
}

// So that the address sanitizer need not follow an exception through SystemC's stacks.
void do_not_throw() {
  sc_core::sc_report_handler::set_actions("/stereotlm/pci_bus", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
}

TEST_F(PciBusTarget, ReportsRoomForMoreThanAsked) {
  bench.bind_stop();
  target.writable = [](auto, auto words) { return words + 1; };
  master.bursts = {write_of(8)};
  bench.request_at(0);
  do_not_throw();
  test::ExpectedReport report("/stereotlm/pci_bus");
  sc_core::sc_start();
  EXPECT_EQ(report.text(), "bus.stop_0: 9 of 8 words can be written");
}

TEST_F(PciBusTarget, HidesTheTimeOfAReadInTheWaitClocks) {
  target.read_delays = clocks(kWait, 0);
  simulate(read_of(3));
  expect_first_word_in(1 + kWait);
}

TEST_F(PciBusTarget, AddsAWaitClockForAReadThatTakesAPicosecondMore) {
  target.read_delays = clocks(kWait, 1);
  simulate(read_of(3));
  expect_first_word_in(1 + kWait + 1);
}

TEST_F(PciBusTarget, CountsTheTimeInWhichAReadBlocks) {
  target.read_waits = clocks(kWait + 6, 1);
  simulate(read_of(3));
  expect_first_word_in(1 + kWait + 7);
  EXPECT_EQ(bench.bus->stats().busy_clocks, 1U + kWait + 7 + 3 + 1 + kWait + 1);
}

TEST_F(PciBusTarget, AddsBlockingAndAnnotatedTime) {
  target.read_waits = clocks(kWait, 0);
  target.read_delays = Clock::to_time(bench.edge(1 + kWait + 2) - bench.edge(1 + kWait));
  simulate(read_of(3));
  expect_first_word_in(1 + kWait + 2);
}

TEST_F(PciBusTarget, KeepsTheBusForTheTimeThatAWriteTakes) {
  constexpr std::uint64_t kEnd = 1 + kWait + 3;
  target.write_delays = Clock::to_time(bench.edge(kEnd + 2) - bench.edge(kEnd) + 1);
  simulate(write_of(3));
  EXPECT_EQ(burst().result.first_data_clock, 1U + kWait);
  EXPECT_EQ(burst().result.words, 3U);
  expect_end_clock(kEnd + 3);
}

TEST_F(PciBusTarget, EndsAWriteThatIsAnsweredWithAnErrorAfterItsWords) {
  target.response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  bench.at(bench.edge(1 + kWait + 3) + 1, [this] { target.response = tlm::TLM_OK_RESPONSE; });
  simulate(write_of(3));
  expect_nothing_transferred(BurstEnd::kTargetError);
  expect_end_clock(1 + kWait + 3);
  EXPECT_EQ(bench.bus->stats().masters[0].aborts, 1U);
}

TEST_F(PciBusTarget, EndsAReadThatIsAnsweredWithAnErrorInTheClockOfItsFirstWord) {
  target.response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
  bench.at(bench.edge(2), [this] { target.response = tlm::TLM_OK_RESPONSE; });
  simulate(read_of(3));
  expect_nothing_transferred(BurstEnd::kTargetError);
  EXPECT_EQ(burst().words, std::vector<std::uint32_t>(3));
  expect_end_clock(1 + kWait + 1);
  EXPECT_EQ(bench.bus->stats().masters[0].aborts, 1U);
}

TEST_F(PciBusTarget, AbortsABurstWithoutTargetAfterFourClocks) {
  for (const std::uint64_t address : {std::uint64_t{0}, std::uint64_t{PciBusBench::kBase} - 4,
                                      std::uint64_t{PciBusBench::kBase} + PciBusBench::kBytes,
                                      (std::uint64_t{1} << 32U) + PciBusBench::kBase}) {
    master.bursts.push_back({true, address, 1});
    master.bursts.push_back({false, address, 1});
  }
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(master.ended[i].result.end, BurstEnd::kMasterAbort);
    EXPECT_EQ(master.ended[i].result.words, 0U);
    EXPECT_EQ(master.ended[i].address_ps, bench.edge(6 * i));
    EXPECT_EQ(master.ended[i].end_ps, bench.edge(6 * i + 5));
  }
  EXPECT_TRUE(target.accesses.empty());
  EXPECT_EQ(bench.bus->stats().masters[0].aborts, 8U);
  EXPECT_EQ(bench.bus->stats().busy_clocks, 8U * 5);
}

TEST_F(PciBusTarget, TransfersABurstToTheEndOfItsWindow) {
  simulate(write_of(4, PciBusBench::kBytes - 16));
  EXPECT_EQ(burst().result.words, 4U);
}

TEST_F(PciBusTarget, AbortsABurstThatLeavesItsWindow) {
  simulate(write_of(5, PciBusBench::kBytes - 16));
  expect_nothing_transferred(BurstEnd::kMasterAbort);
}

TEST_F(PciBusTarget, ReportsAnAddressBetweenWords) {
  master.bursts = {write_of(1, 2)};
  bench.request_at(0);
  do_not_throw();
  test::ExpectedReport report("/stereotlm/pci_bus");
  sc_core::sc_start();
  EXPECT_EQ(report.text(), "address = 65538: must be a multiple of 4");
}

// Requests queue while a read blocks, and the latency timer sees them.
TEST(PciBus, QueuesRequestsWhileAReadBlocks) {
  PciBusBench bench(PciBusBench::with_window(0, 8), 2);
  bench.masters[0]->bursts = {read_of(50)};
  bench.masters[1]->bursts = {write_of(1)};
  bench.targets[0]->read_waits = Clock::to_time(bench.edge(21) - bench.edge(1));
  bench.at(bench.edge(30), [&bench] { bench.targets[0]->read_waits = sc_core::SC_ZERO_TIME; });
  bench.request_at(0, 0);
  bench.request_at(bench.edge(3), 1);
  sc_core::sc_start();
  const auto& read = bench.masters[0]->ended[0];
  EXPECT_EQ(read.result.first_data_clock, 21U);
  EXPECT_EQ(read.result.words, 1U);
  EXPECT_EQ(read.result.end, BurstEnd::kLatencyTimer);
  EXPECT_EQ(bench.masters[1]->ended[0].address_ps, bench.edge(23));
}

TEST(PciBus, ReachesEachWindowWithItsOwnWaitClocks) {
  PciBusConfig config;
  config.windows = {{0x8000, 0x1000, 2}, {0x1000, 0x1000, 7}, {0xFFFF'F000, 0x1000, 0}};
  PciBusBench bench(config);
  TestMaster& master = *bench.masters[0];
  for (const PciWindow& window : config.windows) master.bursts.push_back({true, window.base + 8U, 2});
  bench.request_at(0);
  sc_core::sc_start();
  std::uint64_t clock = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(bench.targets[i]->accesses.size(), 1U);
    EXPECT_EQ(bench.targets[i]->accesses[0].address, 8U);
    EXPECT_EQ(bench.targets[i]->accesses[0].words, words_from(config.windows[i].base + 8U, 2));
    const auto wait_clocks = static_cast<std::uint64_t>(config.windows[i].wait_clocks);
    EXPECT_EQ(master.ended[i].result.first_data_clock, clock + 1 + wait_clocks);
    clock += 1 + wait_clocks + 2 + 1;
  }
}

// A target that grants DMI to its words, and the same bursts as before.
class PciBusMemory : public PciBusTarget {
 protected:
  PciBusMemory() {
    target.memory.resize(PciBusBench::kBytes / 4);
    for (std::size_t i = 0; i < target.memory.size(); ++i) target.memory[i] = word_at(4 * i);
  }
  // One burst each; the first is transported, and asks.
  void simulate(const std::vector<Script>& scripts) {
    master.bursts.assign(scripts.begin(), scripts.end());
    bench.request_at(0);
    sc_core::sc_start();
    ASSERT_EQ(master.ended.size(), scripts.size());
  }
};

TEST_F(PciBusMemory, IsAccessedDirectlyFromTheSecondBurstOnAtTheSameTimes) {
  simulate({read_of(3, 0x40), read_of(3, 0x40), write_of(5, 0x80), read_of(5, 0x80)});
  EXPECT_EQ(target.accesses.size(), 1U);
  EXPECT_EQ(master.ended[0].words, words_from(0x40, 3));
  EXPECT_EQ(master.ended[1].words, words_from(0x40, 3));
  EXPECT_EQ(master.ended[3].words, words_from(PciBusBench::kBase + 0x80, 5));
  std::uint64_t clock = 0;
  for (const auto& burst : master.ended) {
    EXPECT_EQ(burst.result.end, BurstEnd::kComplete);
    EXPECT_EQ(burst.address_ps, bench.edge(clock));
    EXPECT_EQ(burst.result.first_data_clock, clock + 1 + kWait);
    clock += 1 + kWait + burst.result.words;
    EXPECT_EQ(burst.end_ps, bench.edge(clock++));
  }
}

TEST_F(PciBusMemory, IsWrittenWhenTheLastWordIsTransferred) {
  master.bursts = {read_of(1), write_of(4, 0x40)};
  bench.request_at(0);
  const std::uint64_t end_ps = bench.edge(2 * (1 + kWait) + 1 + 1 + 4);
  sc_core::sc_start(Clock::to_time(end_ps - 1));
  EXPECT_EQ(target.memory[0x10], word_at(0x40));
  sc_core::sc_start(Clock::to_time(2));
  EXPECT_EQ(target.memory[0x10], word_at(PciBusBench::kBase + 0x40));
  EXPECT_EQ(master.ended.at(1).end_ps, end_ps);
}

TEST_F(PciBusMemory, IsTransportedToOutsideOfWhatItGrants) {
  target.granted_bytes = 0x40;
  simulate({read_of(1), read_of(16), read_of(2, 0x3c), write_of(2, 0x3c), read_of(1, 0x40)});
  ASSERT_EQ(target.accesses.size(), 4U);
  EXPECT_EQ(target.accesses[1].address, 0x3cU);
  EXPECT_EQ(target.accesses[2].words, words_from(PciBusBench::kBase + 0x3c, 2));
}

TEST_F(PciBusMemory, IsTransportedToOnceItsGrantIsInvalidated) {
  master.on_end = [this] {
    if (master.ended.size() == 2) {
      target.socket->invalidate_direct_mem_ptr(0, UINT64_MAX);
      target.memory.clear();
    }
  };
  simulate({read_of(2), read_of(2), read_of(2), write_of(2), write_of(2)});
  EXPECT_EQ(target.accesses.size(), 4U);
}

TEST_F(PciBusMemory, IsTransportedToIfItsGrantIsTakenBackDuringABurst) {
  target.socket->invalidate_direct_mem_ptr(0, UINT64_MAX);
  master.bursts = {read_of(1), write_of(40), write_of(1)};
  bench.request_at(0);
  bench.at(bench.edge(20), [this] {
    target.socket->invalidate_direct_mem_ptr(0, UINT64_MAX);
    target.memory.clear();
  });
  sc_core::sc_start();
  ASSERT_EQ(target.accesses.size(), 3U);
  EXPECT_EQ(target.accesses[1].words, words_from(PciBusBench::kBase, 40));
  EXPECT_EQ(target.accesses[1].at_ps, master.ended[1].end_ps);
}

TEST_F(PciBusMemory, IsTransportedToIfItTakesTime) {
  target.memory_latency = sc_core::sc_time(1, sc_core::SC_PS);
  simulate({read_of(1), read_of(1), write_of(1)});
  EXPECT_EQ(target.accesses.size(), 3U);
}

}  // namespace
}  // namespace stereotlm::pci
