#include "platform/config/board_area.h"

#include <gtest/gtest.h>

namespace stereotlm::platform {
namespace {

TEST(BoardArea, IsThatOfItsCoreOnItsDevice) {
  BoardConfig board;
  board.matcher.disparities = 200;
  board.allocation.right_lut.reset();
  fpga::CoreConfig core;
  core.disparities = 200;
  core.right_table = false;
  EXPECT_EQ(device_of(board).name, "xc2v6000");
  EXPECT_EQ(area_of(board).slices, area::total(area::items(core), device_of(board)).slices);
  EXPECT_EQ(area_items(board).size(), area::items(core).size());
}

TEST(BoardArea, FitsThePapersDevice) {
  const area::Area area = area_of(BoardConfig());
  EXPECT_EQ(area.slices, 8428);
  EXPECT_EQ(area.block_rams, 15);
  EXPECT_EQ(area.multipliers, 22);
  EXPECT_TRUE(area.fits());
}

TEST(BoardArea, ChangesOnlyWithTheKeysThatChangeTheStructure) {
  const auto slices_after = [](auto change) {
    BoardConfig board;
    change(board);
    return area_of(board).slices;
  };
  const std::int64_t slices = area_of(BoardConfig()).slices;
  EXPECT_NE(slices_after([](BoardConfig& b) { b.matcher.window = 9; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.matcher.disparities = 81; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.matcher.filter.reset(); }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.matcher.fetch = fpga::Fetch::kLineBuffer; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.matcher.lr_tolerance.reset(); }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.fpga.lane_fifo_slots = 17; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.fpga.result_delay_cycles = 2; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.allocation.left_lut.reset(); }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.allocation.left_lut = "bank0"; }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.fpga.clock_mhz = 100; }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.matcher.lr_tolerance = 5; }), slices);
}

// 8428 slices, 15 block RAMs and 22 multipliers.
TEST(BoardArea, NamesTheSmallestDeviceThatFits) {
  BoardConfig board;
  const std::string pins = "; 548 pins: ff1152 has 824, ff1517 1104";
  EXPECT_EQ(device_text(board), "device xc2v6000: fits; the smallest that fits: xc2v2000" + pins);
  board.fpga.device = "xc2v1000";
  EXPECT_EQ(device_text(board), "device xc2v1000: does not fit; the smallest that fits: xc2v2000; 548 pins");
  board.matcher.cost = {kernels::CostKind::kZncc, 0};
  EXPECT_EQ(device_text(board), "device xc2v1000: does not fit; the smallest that fits: none; 548 pins");
  board = BoardConfig();
  board.fpga.package = "ff1517";
  EXPECT_EQ(device_text(board),
            "device xc2v6000: fits; the smallest that fits: xc2v2000; 548 of 1104 pins of ff1517");
}

TEST(BoardArea, CountsThePinsOfThePackage) {
  BoardConfig board;
  EXPECT_FALSE(area_of(board).pins);
  EXPECT_FALSE(area_of(board).pins_percent);
  board.fpga.package = "ff1152";
  EXPECT_EQ(area_of(board).pins, 548);
  EXPECT_DOUBLE_EQ(area_of(board).pins_percent.value(), 100.0 * 548 / 824);
}

// 8 * 61 + 60: 512 Ki words have 19 bits of an address.
TEST(BoardArea, HasThePinsOfEachBankThatHoldsAWord) {
  BoardConfig board;
  const std::vector<PinsOfBank> all = bank_pins(board);
  ASSERT_EQ(all.size(), 8U);
  EXPECT_EQ(all[2].bank, "bank2");
  EXPECT_EQ(all[2].pins.data, 32);
  EXPECT_EQ(all[2].pins.control, 10);
  EXPECT_EQ(all[2].pins.address, 19);
  EXPECT_EQ(pins_of(board), 8 * 61 + 60);
  board.allocation.left_lut = "bank0";
  EXPECT_EQ(pins_of(board), 7 * 61 + 60);
  for (const PinsOfBank& bank : bank_pins(board)) EXPECT_NE(bank.bank, "bank6");
  board.allocation.left_lut.reset();
  EXPECT_EQ(pins_of(board), 7 * 61 + 60);
}

TEST(BoardArea, HasNoPinsForAPartOfAStripeWithoutARow) {
  BoardConfig board;
  board.allocation.left_lut.reset();
  board.allocation.right_lut.reset();
  board.allocation.disparity = {BufferBanks(std::vector<std::string>{"bank4", "bank5", "bank6", "bank7"})};
  EXPECT_EQ(pins_of(board), 8 * 61 + 60);
  board.image.height = 3;
  EXPECT_EQ(pins_of(board), 7 * 61 + 60);
}

TEST(BoardArea, RemarksOnAClockAboveThePapers) {
  BoardConfig board;
  EXPECT_EQ(clock_remark(board), "");
  board.fpga.clock_mhz = 40.5;
  EXPECT_EQ(clock_remark(board).substr(0, 69),
            "fpga.clock_mhz = 40.5: above the 40 MHz that the paper's core reached");
}

}  // namespace
}  // namespace stereotlm::platform
