#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "platform/figures/bounds.h"
#include "tests/support/plain_clock.h"

namespace stereotlm::platform {
namespace {

// The paper's board: 76,800 words a picture.
constexpr double kPicture = 640 * 480 / 4.0;

class ComputerBounds : public ::testing::Test {
 protected:
  double bound_of(const std::string& resource, bool whole_pictures = true) const {
    for (const RateBound& bound : computer_bounds(board, accesses, whole_pictures)) {
      if (bound.resource == resource) return bound.frames_per_second;
    }
    return 0;
  }

  BoardConfig board;
  FrameAccesses accesses;  // none: only what the host moves counts
};

TEST_F(ComputerBounds, GiveCamerasTheirFrameClockOrOnDemandTheTimeToTheLastPixel) {
  EXPECT_EQ(bound_of("camera"), 29.97);
  board.cameras = {25, CameraTrigger::kOnDemand};
  // 525 lines in 40 ms; the last of 640 pixels of line 480 arrives 639/640 into its active part.
  const double line_s = 0.04 / 525;
  EXPECT_NEAR(bound_of("camera"), 1 / (479 * line_s + line_s * 52.15 / 63.56 * 639 / 640), 1e-6);
}

TEST_F(ComputerBounds, CountTheBusClocksOfCaptureToTheBoard) {
  // Captures: bursts of 64 words, because the bridge holds fewer posted words than a FIFO. Result: a
  // descriptor, and bursts of 32 words to memory.
  const double capture = 2 * (kPicture + 1200 * (1 + 4 + 1));
  const double result = (4 + 1 + 8 + 1) + kPicture + 2400 * (1 + 8 + 1);
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (capture + result));
}

TEST_F(ComputerBounds, CountTheBusClocksOfCaptureToHostMemoryAndOfTheCopy) {
  board.capture.destination = CaptureDestination::kHostMemory;
  board.bridge.dma_burst_words = 7;
  const double capture = 2 * (kPicture + 549 * (1 + 8 + 1));       // bursts of 140 words, the last of 80
  const double copy = 2 * (14 + kPicture + 10'972 * (1 + 8 + 1));  // the last burst has 3 words
  const double result = 14 + kPicture + 10'972 * (1 + 8 + 1);
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (capture + copy + result));
}

TEST_F(ComputerBounds, CountADataClockOfPciForTwoWordsOn64Bits) {
  board.pci.width_bits = 64;
  const double capture = 2 * (kPicture / 2 + 1200 * (1 + 4 + 1));
  const double result = (2 + 1 + 8 + 1) + kPicture / 2 + 2400 * (1 + 8 + 1);
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (capture + result));
  board.image = {4, 9};  // 9 words: 5 data clocks
  board.pci.bridge_wait_clocks = 0;
  board.pci.memory_wait_clocks = 0;
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (2 * (5 + 2) + (2 + 2) + (5 + 2)));
}

TEST_F(ComputerBounds, CountTheLocalBusOfAllThreePictures) {
  board.bridge.dma_burst_words = 16;
  EXPECT_DOUBLE_EQ(bound_of("bridge"), 40e6 / (3 * (kPicture + 4800 * 3)));
  board.bridge.local_clock_mhz = 20;
  EXPECT_DOUBLE_EQ(bound_of("bridge"), 20e6 / (3 * (kPicture + 4800 * 3)));
  // On a bus of four clocks per cycle the four clocks between two bursts hide in the cycle of the last grant.
  board.bridge.local_clock_mhz = 160;
  EXPECT_DOUBLE_EQ(bound_of("bridge"), 40e6 / (3 * kPicture));
  board.bridge.local_clock_mhz = 80;
  EXPECT_DOUBLE_EQ(bound_of("bridge"), 40e6 / (3 * (kPicture - 4800 + 4800 * 2)));
}

TEST_F(ComputerBounds, CountTheWaitsOfTheLocalBusForTheEdgesOfBothClocks) {
  board.fpga.clock_mhz = 60;
  using Clocks = std::vector<std::pair<double, double>>;  // MHz, and cycles of the FPGA for 32 words
  for (const auto& [local_mhz, cycles] :
       Clocks{{59, 67}, {60, 35}, {61, 64}, {66, 55}, {90, 34}, {120, 33}}) {
    board.bridge.local_clock_mhz = local_mhz;
    EXPECT_DOUBLE_EQ(bound_of("bridge"), 60e6 / (3 * 2400 * cycles)) << local_mhz;
  }
}

// The bus always has a burst to make, on the clocks of the plain loops.
TEST_F(ComputerBounds, LetNoPlainLocalBusMoveWordsFasterAndAreCloseToIt) {
  const std::array clocks = {"60", "59", "61", "66", "120", "30", "40", "39.9", "10", "33.333", "17.1234"};
  for (std::size_t number = 0; number < 11 * 11 * 4; ++number) {
    const int burst_words = std::array{32, 65, 7, 1}[number / 121];
    const test::PlainClock local(test::plain_number(clocks[number % 11]));
    const test::PlainClock fpga(test::plain_number(clocks[number / 11 % 11]));
    std::uint64_t grant = 0;
    for (int word = 1; word <= burst_words * 100; ++word)
      grant = fpga.first_edge(local.edge(local.first_edge(fpga.edge(grant)) + (word % burst_words ? 1 : 4)));
    const double plain = static_cast<double>(grant) / (burst_words * 100);
    board.fpga.clock_mhz = std::stod(clocks[number / 11 % 11]);
    board.bridge.dma_burst_words = burst_words;
    const double bound = local_bus_cycles_a_word(board, std::stod(clocks[number % 11]));
    EXPECT_LE(bound, plain * (1 + 1e-9)) << number;
    EXPECT_GE(bound, plain * (number < 11 ? 0.95 : 0.5)) << number;  // below 11: beside 60 MHz
  }
}

TEST_F(ComputerBounds, RemarkOnNoLocalClockWithoutABetterOne) {
  for (const double mhz : {8, 14, 20, 40, 60, 160}) {  // 14: no board file can say a third of 40
    board.bridge.local_clock_mhz = mhz;
    EXPECT_EQ(local_bus_remark(board), "");
  }
}

// A load that always requests gets a burst for each burst of the bridge, the master with the most: 2,401. The
// latency timer of 64 clocks cuts longer bursts after the word of clock 64: captures after 60 words (4 wait
// clocks), the load after 64. The bursts of one transfer of the load are left out.
TEST_F(ComputerBounds, CountTheBurstsOfALoadThatTheBusCannotRefuse) {
  const double alone = 33.333e6 / bound_of("pci");
  board.pci.load = PciLoadConfig{100, 0, 0, 0};
  const double capture = 2 * (kPicture + 1280 * (1 + 4 + 1));
  const double result = (4 + 1 + 8 + 1) + kPicture + 2400 * (1 + 8 + 1);
  const double burst = 52;  // on average: 1 + 64 + 1 and 1 + 36 + 1
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (capture + result + 2401 * burst - 2 * burst));
  board.pci.load->burst_words = 5;
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / (capture + result + 2400 * (1 + 5 + 1)));
  // 1 us are 33 whole clocks. A load on time takes 43 of 3333.3 clocks.
  board.pci.load = PciLoadConfig{8, 100, 0, 1};
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / ((alone - 43) / (1 - 43 / 3333.3) - 43));
  board.pci.load->first_us = 5;  // it may begin at the end of the run
  EXPECT_DOUBLE_EQ(bound_of("pci"), 33.333e6 / alone);
}

// The lists have two buffers: a bank is used in every second frame.
TEST_F(ComputerBounds, CountTheAccessesOfTheCoreAndOfTheHostToABank) {
  EXPECT_DOUBLE_EQ(bound_of("bank bank0"), 40e6 * 2 / kPicture);
  EXPECT_DOUBLE_EQ(bound_of("bank bank4"), 40e6 * 2 / (2 * kPicture));  // written, and read back
  EXPECT_EQ(bound_of("bank bank6"), 0) << "no access";
  EXPECT_EQ(bound_of("bank bank0", false), 0);
  accesses.reads = {500, 700, 1000, 2000};
  EXPECT_DOUBLE_EQ(bound_of("bank bank0"), 40e6 * 2 / (kPicture + 1000));
  EXPECT_DOUBLE_EQ(bound_of("bank bank3"), 40e6 * 2 / (kPicture + 2000));
  EXPECT_DOUBLE_EQ(bound_of("bank bank6"), 40e6 / 500);
  EXPECT_DOUBLE_EQ(bound_of("bank bank7"), 40e6 / 700);
  board.allocation.left_image = {"bank0", "bank0"};
  EXPECT_DOUBLE_EQ(bound_of("bank bank0"), 40e6 / (kPicture + 1000));
  board.banks[0].kind = memory::BankKind::kQdr;
  EXPECT_DOUBLE_EQ(bound_of("bank bank0"), 40e6 / kPicture) << "more writes than reads";
  // Pictures that are copied are whole, also where captures lose pixels.
  board.capture.destination = CaptureDestination::kHostMemory;
  EXPECT_DOUBLE_EQ(bound_of("bank bank0", false), 40e6 / kPicture);
  // Of one frame.
  const auto first = computer_bounds(board, accesses, true, 1);
  EXPECT_EQ(first[4].resource, "bank bank2");
  EXPECT_DOUBLE_EQ(first[4].frames_per_second, 40e6 / (kPicture + 2000));
  EXPECT_EQ(first[5].resource, "bank bank4");
}

TEST_F(ComputerBounds, LeaveOutTheWordsOfCapturesWherePixelsAreDropped) {
  const double moved = (4 + 1 + 8 + 1) + kPicture + 2400 * (1 + 8 + 1);
  EXPECT_DOUBLE_EQ(bound_of("pci", false), 33.333e6 / moved);
  EXPECT_DOUBLE_EQ(bound_of("bridge", false), 40e6 / (kPicture + 2400 * 3));
  board.capture.destination = CaptureDestination::kHostMemory;
  EXPECT_DOUBLE_EQ(bound_of("pci", false), 33.333e6 / (3 * moved));
  EXPECT_DOUBLE_EQ(bound_of("bridge", false), bound_of("bridge", true));
}

TEST_F(ComputerBounds, GiveTheSystemTheLeastBound) {
  Bound bound;
  bound.core = 18.5;
  bound.core_limited_by = "matcher";
  add_system_bound(board, accesses, true, bound);
  EXPECT_EQ(bound.system, 18.5);
  EXPECT_EQ(bound.system_limited_by, "matcher");
  bound.core = 130;
  add_system_bound(board, accesses, true, bound);
  EXPECT_EQ(bound.system, 29.97);
  EXPECT_EQ(bound.system_limited_by, "camera");
  board.pci.clock_mhz = 1;
  add_system_bound(board, accesses, true, bound);
  EXPECT_EQ(bound.system_limited_by, "pci");
}

}  // namespace
}  // namespace stereotlm::platform
