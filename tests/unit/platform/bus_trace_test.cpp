// The trace of buses and queues, with hand-made reports of the blocks. Random computers compare traces with
// the plain loop over events, which has no targets.
#include "platform/records/bus_trace.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/computer_parts.h"

namespace stereotlm::platform {
namespace {

using Lines = std::vector<std::string>;

class LineObserver : public BusObserver {
 public:
  void burst(const BusBurst& burst) override {
    lines.push_back(fmt::format("{}>{} {}{} at {:x}: {} {} {} {}", burst.master, burst.target,
                                burst.write ? 'w' : 'r', burst.words, burst.address, burst.request_ps,
                                burst.address_ps, burst.data_ps, burst.end_ps));
  }
  void level(const QueueLevel& /*level*/) override {}
  Lines lines;
};

class BusTraceTest : public ::testing::Test {
 protected:
  BusTrace& trace(const fpga::CycleWindow& window = {}) {
    return trace_.emplace(BoardConfig(), window, observer);
  }
  // A burst on the PCI bus from its request to its end.
  void pci(std::uint64_t request_ps, std::uint64_t end_ps) {
    trace_->pci_burst_ended(
        {kHost, kHostMemory, true, 0x100, 1, request_ps, request_ps, request_ps + 1, end_ps});
  }
  Lines handed_out() {
    observer.lines.clear();
    trace_->hand_out(kNever - 1);
    return observer.lines;
  }

  LineObserver observer;
  std::optional<BusTrace> trace_;
};

TEST_F(BusTraceTest, NamesMastersAndTargetsOfThePciBus) {
  trace();
  trace_->pci_burst_ended({kLeftCapture, kBridgeSlave, true, 0xC0000000, 8, 1, 2, 3, 4});
  trace_->pci_burst_ended({kBridge, std::nullopt, false, 0xFFFFFFF0, 0, 5, 6, 7, 8});
  trace_->pci_burst_ended({kTrafficGenerator, kTrafficDevice, false, 0xE2000000, 2, 9, 10, 11, 12});
  EXPECT_EQ(handed_out(),
            (Lines{"left_capture>bridge w8 at c0000000: 1 2 3 4", "bridge>none r0 at fffffff0: 5 6 7 8",
                   "load>load r2 at e2000000: 9 10 11 12"}));
}

TEST_F(BusTraceTest, RefusesRowsOfNoFrame) {
  fpga::CycleWindow window;
  window.unit = fpga::CycleWindow::Unit::kRows;
  EXPECT_THROW(trace(window), std::invalid_argument);
  window.unit = fpga::CycleWindow::Unit::kCycles;
  EXPECT_NO_THROW(trace(window));
}

// Cycles 4 and 5, of 25 ns.
TEST_F(BusTraceTest, HasTheBurstsThatAreUnderWayInItsCycles) {
  fpga::CycleWindow window;
  window.first = 4;
  window.last = 5;
  trace(window);
  pci(1, 100'000);
  pci(2, 100'001);
  pci(149'999, 160'000);
  pci(150'000, 170'000);
  EXPECT_EQ(handed_out(), (Lines{"host>host_memory w1 at 100: 2 2 3 100001",
                                 "host>host_memory w1 at 100: 149999 149999 150000 160000"}));
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
