// The host port beside the core's own: bursts of the local bus before, in and after a frame. Its clock is the
// core's: a burst that begins at edge c asks from cycle c + kFirst on, and a word a cycle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expected_report.h"
#include "tests/unit/fpga/stereo_core_bench.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
using memory::Port;
using sc_core::sc_time;
using test::TestHost;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

const sc_time kPicosecond = sc_time::from_value(1);
constexpr std::uint64_t kFirst = 3;     // address, decode and word clock
constexpr std::uint64_t kReadEnd = 3;   // read latency and idle clock, from the cycle of the last grant
constexpr std::uint64_t kWriteEnd = 1;  // idle clock

class StereoCoreHost : public StereoCoreFidelities {
 protected:
  static StereoCoreConfig host_last() {
    StereoCoreConfig board = small_board();
    board.memory.arbiter.priority = {Port::kResult,  Port::kLeftPixel, Port::kRightPixel,
                                     Port::kLeftLut, Port::kRightLut,  Port::kHost};
    return board;
  }
  void expect_nothing_counted() const {
    for (const memory::BankArbiter& arbiter : core->crossbar().arbiters()) {
      const memory::ArbiterStats stats = arbiter.stats();
      EXPECT_EQ(stats.grants[memory::index_of(Port::kHost)], 0U);
    }
    EXPECT_EQ(port(Port::kHost).granted(), 0U);
  }
  std::uint64_t uncounted() const {
    std::uint64_t accesses = 0;
    for (const memory::BankArbiter& arbiter : core->crossbar().arbiters())
      accesses += arbiter.uncounted_accesses();
    return accesses;
  }
};

TEST_P(StereoCoreHost, ReachesTheBanksWhileNoFrameRuns) {
  build(small_board());
  at(edge(5), [this] { memory.access(TLM_WRITE_COMMAND, crossbar_address(kSpare, 3), 77); });
  at(edge(10) + kPicosecond, [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 3)); });
  finish();
  ASSERT_EQ(memory.answers.size(), 2U);
  EXPECT_EQ(memory.answers[0].at, edge(5 + kFirst + kWriteEnd));
  EXPECT_EQ(memory.answers[1].word, 77U);
  EXPECT_EQ(memory.answers[1].at, edge(11 + kFirst + kReadEnd));
  expect_nothing_counted();
  EXPECT_EQ(uncounted(), 2U);
  EXPECT_EQ(port(Port::kHost).sum(), 0U);
}

TEST_P(StereoCoreHost, ReachesABankByBursts) {
  build(small_board());
  at(edge(1), [this] {
    memory.access(TLM_WRITE_COMMAND, crossbar_address(kSpare, 7), std::vector<std::uint32_t>{1, 2, 3, 4});
    memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 8), std::vector<std::uint32_t>(3));
  });
  finish();
  ASSERT_EQ(memory.answers.size(), 2U);
  const std::uint64_t written = 1 + kFirst + 3 + kWriteEnd;
  EXPECT_EQ(memory.answers[0].at, edge(written));
  EXPECT_EQ(memory.answers[1].at, edge(written + kFirst + 2 + kReadEnd));
  EXPECT_EQ(memory.answers[1].words, (std::vector<std::uint32_t>{2, 3, 4}));
  EXPECT_EQ(uncounted(), 7U);
}

TEST_P(StereoCoreHost, StartsAFrameAtTheEndOfTheClockThatCarriesTheStrobe) {
  build(small_board());
  at(edge(2), [this] {
    memory.access(TLM_WRITE_COMMAND, kLocalRegisters + registers::kControl, registers::kControlStart);
  });
  finish();
  EXPECT_EQ(done_at, std::vector<sc_time>{edge(2 + kFirst + frame_cycles_alone(4))});
}

TEST_P(StereoCoreHost, ReachesTheBanksWordAfterWord) {
  build(small_board());
  at(edge(1), [this] {
    for (std::uint32_t word = 0; word < 5; ++word)
      memory.access(TLM_READ_COMMAND, crossbar_address(kLeft, word));
  });
  finish();
  ASSERT_EQ(memory.answers.size(), 5U);
  for (std::uint32_t word = 0; word < 5; ++word) {
    EXPECT_EQ(memory.answers[word].word, words_of(left)[word]);
    EXPECT_EQ(memory.answers[word].at, edge(1 + (kFirst + kReadEnd) * (word + 1)));
  }
}

TEST_P(StereoCoreHost, DelaysAFrameByEachCycleThatItTakesFromAPixelPort) {
  build(small_board());
  at(edge(0), [this] { start(); });
  // Slot 1 of the sequence is read in cycle 3 (tables 2 cycles); the host is first in the list.
  at(edge(3 - kFirst), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kLeft, 4)); });
  finish();
  ASSERT_EQ(memory.answers.size(), 1U);
  EXPECT_EQ(memory.answers[0].word, words_of(left)[4]);
  EXPECT_EQ(memory.answers[0].at, edge(3 + kReadEnd));
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4) + 1});
  EXPECT_EQ(port(Port::kHost).granted(), 1U);
  EXPECT_EQ(port(Port::kHost).stalled(), 0U);
  EXPECT_EQ(port(Port::kHost).idle(), frame_cycles_alone(4) + 1 - pipeline() - 1);
  EXPECT_EQ(port(Port::kLeftPixel).stalled(), 1U);
  EXPECT_EQ(blamed(kLeft, Port::kLeftPixel, Port::kHost), 1U);
  EXPECT_EQ(uncounted(), 0U);
}

TEST_P(StereoCoreHost, CostsNothingInABankThatNoPortWants) {
  build(small_board());
  at(edge(0), [this] { start(); });
  at(edge(3 - kFirst), [this] { memory.access(TLM_WRITE_COMMAND, crossbar_address(kSpare, 0), 5); });
  finish();
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(memory.answers[0].at, edge(3 + kWriteEnd));
  EXPECT_EQ(port(Port::kHost).granted(), 1U);
  const memory::ArbiterStats stats = core->crossbar().arbiters()[kSpare].stats();
  EXPECT_EQ(stats.writes, 1U);
  EXPECT_EQ(stats.idle_cycles, frame_cycles_alone(4) - pipeline() - 1);
}

TEST_P(StereoCoreHost, WaitsForAPreferredPortAndBlamesIt) {
  build(host_last());
  at(edge(0), [this] { start(); });
  // Slots 1 and 2 are read in cycles 3 and 4; slot 3, the next column's first, is empty in cycle 5.
  at(edge(3 - kFirst), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kLeft, 4)); });
  finish();
  ASSERT_EQ(memory.answers.size(), 1U);
  EXPECT_EQ(memory.answers[0].at, edge(5 + kReadEnd));
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(port(Port::kHost).stalled(), 2U);
  EXPECT_EQ(port(Port::kHost).granted(), 1U);
  EXPECT_EQ(blamed(kLeft, Port::kHost, Port::kLeftPixel), 2U);
  EXPECT_EQ(core->crossbar().arbiters()[kLeft].stats().contended_cycles, 2U);
}

TEST_P(StereoCoreHost, TakesPartFromTheFirstCycleAtOrAfterItsRequest) {
  build(small_board());
  at(edge(0), [this] { start(); });
  at(edge(20), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 0)); });
  at(edge(30) + kPicosecond, [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 0)); });
  at(edge(40),
     [this] { memory.request(TLM_READ_COMMAND, crossbar_address(kSpare, 0), 0, edge(3) - kPicosecond); });
  finish();
  ASSERT_EQ(memory.answers.size(), 3U);
  EXPECT_EQ(memory.answers[0].at, edge(20 + kFirst + kReadEnd));
  EXPECT_EQ(memory.answers[1].at, edge(31 + kFirst + kReadEnd));
  EXPECT_EQ(memory.answers[2].at, edge(43 + kFirst + kReadEnd));
}

TEST_P(StereoCoreHost, IsServedWhileTheFrameRunsOutAndNotCounted) {
  StereoCoreConfig board = small_board();
  board.core.pipeline_latency_cycles = 20;
  build(board);
  at(edge(0), [this] { start(); });
  const std::uint64_t last_write = frame_cycles_alone(4) - pipeline() - 1;
  at(edge(last_write - kFirst), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 0)); });
  at(edge(last_write + 3), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kResult, 11)); });
  finish();
  ASSERT_EQ(memory.answers.size(), 2U);
  EXPECT_EQ(memory.answers[0].at, edge(last_write + kReadEnd));
  EXPECT_EQ(memory.answers[1].at, edge(last_write + 3 + kFirst + kReadEnd));
  EXPECT_EQ(memory.answers[1].word, banks[kResult]->words()[11]);
  EXPECT_EQ(port(Port::kHost).granted(), 1U);  // in the cycle of the last write, and no later
  EXPECT_EQ(uncounted(), 1U);
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(done_at, std::vector<sc_time>{edge(frame_cycles_alone(4))});
}

TEST_P(StereoCoreHost, AsksThroughTheEndOfAFrameAndTheBeginOfTheNext) {
  build(small_board());
  on_done = [this] {
    if (frame_cycles().size() == 1) start();
  };
  at(edge(0), [this] {
    start();
    while (frame_cycles().size() < 2) memory.access(TLM_READ_COMMAND, crossbar_address(kSpare, 0));
  });
  finish();
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>(2, frame_cycles_alone(4)));
  for (std::size_t word = 1; word < memory.answers.size(); ++word)
    EXPECT_EQ(memory.answers[word].at - memory.answers[word - 1].at, edge(kFirst + kReadEnd)) << word;
  EXPECT_EQ(port(Port::kHost).granted() + uncounted(), memory.answers.size());
  const std::uint64_t counted = frame_cycles_alone(4) - pipeline();
  EXPECT_EQ(port(Port::kHost).sum(), 2 * counted);
}

TEST_P(StereoCoreHost, SeesTheWordsThatAFrameHasWritten) {
  build(small_board());
  start();
  finish();
  for (std::uint32_t word = 0; word < 12; ++word) {
    at(sc_core::sc_time_stamp(),
       [this, word] { memory.access(TLM_READ_COMMAND, crossbar_address(kResult, word)); });
    finish();
    EXPECT_EQ(memory.answers.back().word, banks[kResult]->words()[word]);
  }
}

TEST_P(StereoCoreHost, IsRefusedABlockingAccess) {
  build(small_board());
  EXPECT_EQ(memory.read(crossbar_address(kSpare, 0)).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
}

TEST_P(StereoCoreHost, IsGrantedDirectAccess) {
  build(small_board());
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(memory.dmi(crossbar_address(kResult, 0), dmi));
  EXPECT_EQ(dmi.get_start_address(), crossbar_address(kResult, 0));
  EXPECT_EQ(dmi.get_end_address(), crossbar_address(kResult, kWords) - 1);
}

// A host that writes a word in every cycle, and is served first, keeps a reader of that bank waiting.
class StereoCoreStarved : public StereoCoreHost {
 protected:
  static constexpr std::uint64_t kPatience = 10'000;

  void write_for(std::uint64_t cycles, std::uint64_t patience = kPatience) {
    StereoCoreConfig board = small_board();
    board.memory.banks.assign(kBankCount, {65'536});
    board.stall_timeout_cycles = patience;
    build(board);
    start();
    at(edge(1), [this, cycles] {
      memory.access(TLM_WRITE_COMMAND, crossbar_address(kLeft, 1000), std::vector<std::uint32_t>(cycles));
    });
  }
};

TEST_P(StereoCoreStarved, GoesOnAfterShorterThanItsPatience) {
  write_for(kPatience - 10);
  run_until(edge(30'000));
  EXPECT_EQ(done_at.size(), 1U);
}

TEST_P(StereoCoreStarved, IsNotReportedOfAFrameThatBeginsLate) {
  StereoCoreConfig board = small_board();
  board.stall_timeout_cycles = kPatience;
  build(board);
  for (const std::uint64_t cycle : {2 * kPatience, 5 * kPatience}) at(edge(cycle), [this] { start(); });
  run_until(edge(6 * kPatience));
  EXPECT_EQ(done_at.size(), 2U);
}

TEST_P(StereoCoreStarved, SaysWhoWaitsForWhat) {
  write_for(30'000);
  // Not thrown, so that the address sanitizer need not follow it through SystemC's stacks.
  sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/core");
  run_until(edge(30'000));
  EXPECT_THAT(expected.text(),
              testing::ContainsRegex("core: no slot consumed and no result written for 1[0-9]+ cycles; "
                                     "frame 0 of the core, cycle 2[0-9]+; left_lut is blocked: its "
                                     "lane is full; right_lut is blocked: its lane is full; "
                                     "left_pixel asks for bank number 0, lost 2[0-9]+ cycles to host; "
                                     "right_pixel is starved; result is idle; host asks for bank number 0"));
}

// It is checked every 8192 cycles.
TEST_P(StereoCoreStarved, IsReportedAsSoonAsItsPatienceHasPassed) {
  sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/core");
  write_for(40'000, 2 * 8192);
  run_until(edge(30'000));
  EXPECT_THAT(expected.text(), testing::HasSubstr("no result written for 16384 cycles"));
}

INSTANTIATE_TEST_SUITE_P(Fidelities, StereoCoreHost, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         name_of_fidelity);
INSTANTIATE_TEST_SUITE_P(Fidelities, StereoCoreStarved, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         name_of_fidelity);

}  // namespace
}  // namespace stereotlm::fpga
