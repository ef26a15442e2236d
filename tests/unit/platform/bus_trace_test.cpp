// The trace of buses and queues, with hand-made reports of the blocks. The tests of the skips trace whole
// computers; random computers compare traces with the plain loop over events.
#include "platform/bus_trace.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/local_bus_control.h"
#include "platform/computer_parts.h"

namespace stereotlm::platform {
namespace {

using Lines = std::vector<std::string>;
using pci::LocalBusSource;

constexpr std::uint64_t kCycle = 25'000;  // of the core, and a clock of the local bus

class LineObserver : public BusObserver {
 public:
  void burst(const BusBurst& burst) override {
    lines.push_back(fmt::format("{}>{} {}{} at {:x}: {} {} {} {}", burst.master, burst.target,
                                burst.write ? 'w' : 'r', burst.words, burst.address, burst.request_ps,
                                burst.address_ps, burst.data_ps, burst.end_ps));
  }
  void level(const QueueLevel& level) override {
    lines.push_back(fmt::format("{} {}@{}", level.queue, level.words, level.time_ps));
  }
  Lines lines;
};

class BusTraceTest : public ::testing::Test {
 protected:
  BusTrace& trace(const fpga::CycleWindow& window = {}) {
    return trace_.emplace(BoardConfig(), window, observer);
  }
  // A burst on the PCI bus from its request to its end.
  void pci(std::uint64_t request_ps, std::uint64_t end_ps) {
    trace_->pci_bus().pci_burst_ended(
        {kHost, kHostMemory, true, 0x100, 1, request_ps, request_ps, request_ps + 1, end_ps});
  }
  Lines handed_out(std::uint64_t now_ps = kNever - 1) {
    observer.lines.clear();
    trace_->hand_out(now_ps);
    return observer.lines;
  }
  static std::string pci_line(std::uint64_t request_ps, std::uint64_t end_ps) {
    return fmt::format("host>host_memory w1 at 100: {0} {0} {1} {2}", request_ps, request_ps + 1, end_ps);
  }

  LineObserver observer;
  std::optional<BusTrace> trace_;
};

TEST_F(BusTraceTest, NamesMastersAndTargetsOfThePciBus) {
  trace();
  trace_->pci_bus().pci_burst_ended({kLeftCapture, kBridgeSlave, true, 0xC0000000, 8, 1, 2, 3, 4});
  trace_->pci_bus().pci_burst_ended({kBridge, std::nullopt, false, 0xFFFFFFF0, 0, 5, 6, 7, 8});
  trace_->pci_bus().pci_burst_ended({kTrafficGenerator, kTrafficDevice, false, 0xE2000000, 2, 9, 10, 11, 12});
  EXPECT_EQ(handed_out(),
            (Lines{"left_capture>bridge w8 at c0000000: 1 2 3 4", "bridge>none r0 at fffffff0: 5 6 7 8",
                   "load>load r2 at e2000000: 9 10 11 12"}));
}

// Two writes of 4 words wait. A burst takes 6 of these words, and the next one the rest.
TEST_F(BusTraceTest, GivesAPostedBurstTheRequestOfItsOldestWord) {
  BusTrace& to = trace();
  to.bridge().words_posted(kCycle + 1, 4);
  to.bridge().words_posted(3 * kCycle, 4);
  to.bridge().burst_begins(4 * kCycle, LocalBusSource::kPosted, 6);
  to.bridge().posted_words_leave(13 * kCycle, 6);
  to.local_bus().local_burst_ended(
      {true, std::uint64_t{3} << 28U, 6, 4 * kCycle, 5 * kCycle, 12 * kCycle, 13 * kCycle});
  to.bridge().burst_begins(13 * kCycle, LocalBusSource::kPosted, 2);
  to.bridge().posted_words_leave(18 * kCycle, 2);
  to.local_bus().local_burst_ended(
      {true, fpga::kLocalRegisters, 2, 13 * kCycle, 14 * kCycle, 17 * kCycle, 18 * kCycle});
  EXPECT_EQ(handed_out(), (Lines{"posted>bank3 w6 at 30000000: 50000 100000 125000 300000",
                                 "posted>registers w2 at 400000000: 75000 325000 350000 425000",
                                 "posted 4@25001", "posted 8@75000", "posted 2@325000", "posted 0@450000"}));
}

TEST_F(BusTraceTest, GivesAReadAndATransferOfDmaTheTimeSinceWhichTheyWait) {
  BusTrace& to = trace();
  const auto burst = [&](LocalBusSource source, std::uint64_t clock) {
    to.bridge().burst_begins(clock * kCycle, source, 1);
    to.local_bus().local_burst_ended(
        {false, 0, 1, clock * kCycle, (clock + 1) * kCycle, (clock + 3) * kCycle, (clock + 4) * kCycle});
  };
  to.bridge().transfer_waits(kCycle - 1, LocalBusSource::kDma1);
  to.bridge().transfer_waits(2 * kCycle, LocalBusSource::kRead);
  to.bridge().transfer_waits(3 * kCycle, LocalBusSource::kDma0);
  burst(LocalBusSource::kRead, 5);
  burst(LocalBusSource::kDma1, 9);
  to.bridge().transfer_waits(7 * kCycle, LocalBusSource::kDma0);  // instead
  burst(LocalBusSource::kDma0, 13);
  EXPECT_EQ(handed_out(), (Lines{"read>bank0 r1 at 0: 50000 125000 150000 200000",
                                 "dma1>bank0 r1 at 0: 25000 225000 250000 300000",
                                 "dma0>bank0 r1 at 0: 175000 325000 350000 400000"}));
}

// The local bus has refused the first burst, whose words leave at once.
TEST_F(BusTraceTest, KeepsTheLevelOfPostedWordsOfARefusedBurst) {
  BusTrace& to = trace();
  to.bridge().words_posted(10, 3);
  to.bridge().burst_begins(10, LocalBusSource::kPosted, 3);
  to.bridge().posted_words_leave(10, 3);
  to.bridge().words_posted(20, 2);
  EXPECT_EQ(handed_out(), (Lines{"posted 3@10", "posted 0@10", "posted 2@20"}));
}

// Cycles 100 to 199 are traced.
TEST_F(BusTraceTest, HoldsBurstsThatEndAfterItsBeginningAndRequestBeforeItsEnd) {
  constexpr std::uint64_t kBegin = 100 * kCycle;
  constexpr std::uint64_t kEnd = 200 * kCycle;
  fpga::CycleWindow window;
  window.first = 100;
  window.last = 199;
  BusTrace& to = trace(window);
  pci(kBegin - 100, kBegin);
  pci(kBegin - 90, kBegin + 1);
  pci(kEnd - 1, kEnd + 100);
  pci(kEnd, kEnd + 200);
  for (const std::uint64_t time_ps : {kBegin, kBegin + 1, kEnd, kEnd + 1})
    to.capture_fifo(1).word_came(time_ps);
  EXPECT_EQ(handed_out(), (Lines{pci_line(kBegin - 90, kBegin + 1), pci_line(kEnd - 1, kEnd + 100),
                                 "right_capture 2@2500001", "right_capture 3@5000000"}));
  EXPECT_EQ(to.skips_end_ps(0), kBegin);
  EXPECT_EQ(to.skips_end_ps(kEnd), kBegin);  // nothing is skipped
  EXPECT_EQ(to.skips_end_ps(kEnd + 1), kNever);
}

// Words that leave are reported later, and what was asked for early is reported again.
TEST_F(BusTraceTest, HasOneLevelOfAFifoForEachTimeAtWhichWordsComeOrLeave) {
  BusTrace& to = trace();
  capture::FifoObserver& fifo = to.capture_fifo(0);
  to.set_show_words([&fifo](std::uint64_t now_ps) {
    for (std::uint64_t time_ps = 10; time_ps <= now_ps && time_ps <= 50; time_ps += 10)
      fifo.word_came(time_ps);
  });
  EXPECT_EQ(handed_out(25), (Lines{"left_capture 1@10", "left_capture 2@20"}));
  fifo.word_came(10);
  fifo.words_left(30, 1);
  fifo.words_left(35, 2);
  fifo.words_left(60, 1);
  EXPECT_EQ(handed_out(50),
            (Lines{"left_capture 2@30", "left_capture 0@35", "left_capture 1@40", "left_capture 2@50"}));
  EXPECT_EQ(handed_out(), (Lines{"left_capture 1@60"}));
}

TEST_F(BusTraceTest, HoldsAFrameOfTheCoreFromItsStrobeToItsEnd) {
  fpga::CycleWindow window;
  window.frame = 1;
  window.unit = fpga::CycleWindow::Unit::kRows;  // of the whole frame
  window.first = 3;
  BusTrace& to = trace(window);
  to.core().frame_begun(1'000);
  pci(900, 1'100);
  to.core().frame_ended({1'000, 1, 10, 20, 1});
  EXPECT_EQ(to.skips_end_ps(30 * kCycle), kNever);
  pci(28 * kCycle, 29 * kCycle);
  to.capture_fifo(0).word_came(28 * kCycle);
  EXPECT_EQ(handed_out(29 * kCycle), Lines()) << "before the frame begins";
  pci(29 * kCycle, 30 * kCycle);
  to.capture_fifo(0).word_came(30 * kCycle);
  to.core().frame_begun(30 * kCycle);
  to.capture_fifo(0).word_came(30 * kCycle + 1);
  EXPECT_EQ(to.skips_end_ps(30 * kCycle), 30 * kCycle);
  pci(29 * kCycle, 31 * kCycle);
  // Its request is behind the end of the frame, which is not known yet.
  to.bridge().transfer_waits(39 * kCycle + 1, LocalBusSource::kRead);
  to.bridge().burst_begins(39 * kCycle + 1, LocalBusSource::kRead, 1);
  to.local_bus().local_burst_ended({false, 0, 1, 40 * kCycle, 41 * kCycle, 43 * kCycle, 44 * kCycle});
  to.core().frame_ended({30 * kCycle, 31, 38, 40, 1});
  EXPECT_EQ(to.skips_end_ps(40 * kCycle), 30 * kCycle);
  EXPECT_EQ(to.skips_end_ps(40 * kCycle + 1), kNever);
  pci(40 * kCycle - 1, 50 * kCycle);
  pci(40 * kCycle, 60 * kCycle);
  to.core().frame_begun(70 * kCycle);
  pci(70 * kCycle, 71 * kCycle);
  EXPECT_EQ(handed_out(), (Lines{pci_line(29 * kCycle, 31 * kCycle), pci_line(40 * kCycle - 1, 50 * kCycle),
                                 "left_capture 3@750001"}));
}

TEST_F(BusTraceTest, HandsOutWhatHasHappenedByATimeAndEachRecordOnce) {
  BusTrace& to = trace();
  pci(1, 90);
  to.bridge().words_posted(80, 1);
  to.bridge().burst_begins(80, LocalBusSource::kPosted, 1);
  to.bridge().posted_words_leave(5 * kCycle, 1);
  to.local_bus().local_burst_ended({true, 0, 1, kCycle, 2 * kCycle, 4 * kCycle, 5 * kCycle});
  EXPECT_EQ(handed_out(89), Lines{"posted 1@80"});
  EXPECT_EQ(handed_out(5 * kCycle - 1), Lines{pci_line(1, 90)});
  EXPECT_EQ(handed_out(5 * kCycle),
            (Lines{"posted>bank0 w1 at 0: 25000 25000 50000 100000", "posted 0@125000"}));
  EXPECT_EQ(handed_out(), Lines());
}

TEST_F(BusTraceTest, RefusesRowsOfNoFrame) {
  fpga::CycleWindow window;
  window.unit = fpga::CycleWindow::Unit::kRows;
  EXPECT_THROW(trace(window), std::invalid_argument);
  window.unit = fpga::CycleWindow::Unit::kCycles;
  EXPECT_NO_THROW(trace(window));
}

// No run is as long.
TEST_F(BusTraceTest, IsEmptyInCyclesThatNoRunReaches) {
  fpga::CycleWindow window;
  window.first = UINT64_MAX / 2;
  trace(window);
  pci(1, 2);
  pci(std::uint64_t{1} << 59U, std::uint64_t{1} << 60U);
  EXPECT_EQ(handed_out(), Lines());
}

}  // namespace
}  // namespace stereotlm::platform
