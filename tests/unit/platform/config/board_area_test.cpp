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
  EXPECT_EQ(area.slices, 7420);
  EXPECT_EQ(area.block_rams, 17);
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
  EXPECT_NE(slices_after([](BoardConfig& b) { b.fpga.result_fifo_words = 17; }), slices);
  EXPECT_NE(slices_after([](BoardConfig& b) { b.allocation.left_lut.reset(); }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.allocation.left_lut = "bank0"; }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.fpga.clock_mhz = 100; }), slices);
  EXPECT_EQ(slices_after([](BoardConfig& b) { b.matcher.lr_tolerance = 5; }), slices);
}

// 7420 slices, 17 block RAMs and 22 multipliers.
TEST(BoardArea, NamesTheSmallestDeviceThatFits) {
  BoardConfig board;
  EXPECT_EQ(device_text(board), "device xc2v6000: fits; the smallest that fits: xc2v1500");
  board.fpga.device = "xc2v1000";
  EXPECT_EQ(device_text(board), "device xc2v1000: does not fit; the smallest that fits: xc2v1500");
  board.matcher.cost = {kernels::CostKind::kZncc, 0};
  EXPECT_EQ(device_text(board), "device xc2v1000: does not fit; the smallest that fits: none");
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
