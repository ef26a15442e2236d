#include "platform/config/board_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/register_map.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using ::testing::ElementsAre;
using Problems = std::vector<std::string>;

TEST(BoardConfig, ReportsEveryBrokenRuleInTheOrderOfTheKeys) {
  BoardConfig board;
  board.name = "a\nb";
  board.image.width = 642;
  board.cameras.frame_rate_hz = std::nan("");
  board.capture.fifo_trigger_words = 141;
  board.pci.clock_mhz = std::numeric_limits<double>::infinity();
  board.pci.load = PciLoadConfig{0, -0.5, 0, 1000000.5};
  board.fpga.device = "xc4vlx25";
  board.fpga.arbiter.policy = "lottery";
  board.fpga.arbiter.priority[0] = fpga::kResultGroup;
  board.fpga.arbiter.priority[2] = 6;
  board.banks[1].name = "bank0";
  board.banks[2].name = "none";
  board.banks[3].words = 0;
  board.banks[4].kind = memory::BankKind::kSyncBurst;
  board.allocation.disparity = {};
  board.matcher.filter = kernels::FilterKernel{7, {1, 2}, 32};
  board.matcher.lr_tolerance = 254;
  board.matcher.units = 255;
  board.matcher.rows = 17;
  board.matcher.cost.census_size = 4;
  board.fpga.pixel_cache = static_cast<fpga::PixelCache>(2);
  EXPECT_EQ(
      problems(board),
      (Problems{
          "name = \"a\\nb\": a text of one or more characters without control characters; quoted if it "
          "could be read as a number, a truth value or null",
          "image.width = 642: 4..8192, a multiple of 4",
          "cameras.frame_rate_hz = nan: not a decimal number (such as 29.97, not in quotes); 0.1..1000",
          "pci.clock_mhz = inf: not a decimal number (such as 29.97, not in quotes); 1..1000",
          "pci.load.burst_words = 0: 1..1024",
          "pci.load.interval_us = -0.5: 0..1000000000",
          "pci.load.access_us = 1000000.5: 0..1000000",
          "fpga.device = xc4vlx25: must be one of xc2v1000, xc2v1500, xc2v2000, xc2v3000, "
          "xc2v4000, xc2v6000 or xc2v8000",
          "fpga.arbitration = lottery: must be one of fixed_priority, round_robin or age",
          "fpga.priority = result: repeated; each port once",
          "fpga.priority = \"(no port)\": must be one of left_lut, right_lut, left_pixel, right_pixel, "
          "result or host",
          "fpga.pixel_cache = \"2\": must be one of none or word",
          "ssram.banks.bank0 = {}: repeated key",
          "ssram.banks.none = {}: a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none",
          "ssram.banks.bank3.words = 0: 1..67108864",
          "ssram.banks.bank4.turnaround_cycles = 0: 1..16",
          "allocation.disparity = []: a bank, a stripe {rows: [..]} of 2..16 banks, or a list of 1 to 3 of "
          "them",
          "matcher.filter.kernel = [[1, 2]]: a square list of lists, 3..31, odd rows, entries "
          "-32768..32767, sum 0",
          "matcher.filter.shift = 32: 0..31",
          "matcher.lr_tolerance = 254: 0..253 or off",
          "matcher.units = 255: 1..254 or all",
          "matcher.rows = 17: 1..16",
          "matcher.cost.sad = 4: unknown key; nearest known key: pci.load",
          "matcher.cost.census: missing: 3, 5 or 7",
          "capture.fifo_trigger_words = 141: 1..fifo_words, which is 140"}));
  EXPECT_THROW(require_valid(board), std::invalid_argument);
}

TEST(BoardConfig, IsCheckedByTheRulesBetweenKeys) {
  BoardConfig board;
  EXPECT_EQ(problems(board), Problems{});
  board.allocation.left_lut = "bank9";
  board.matcher.units = 81;
  EXPECT_EQ(problems(board),
            (Problems{"allocation.left_lut = bank9: not a bank of this board; nearest: bank0",
                      "matcher.units = 81: 1..disparities, which is 80, or all"}));
  board = BoardConfig();
  board.banks.clear();
  EXPECT_EQ(problems(board), Problems{"ssram.banks = {}: 0 banks; a map of 1..64 banks"});
}

TEST(BoardConfig, HandsOptionalKeysToTheCore) {
  BoardConfig board;
  board.matcher.units = 40;
  board.matcher.rows = 4;
  board.matcher.cost = {kernels::CostKind::kCensus, 7};
  board.allocation.right_lut = board.allocation.left_lut;
  board.banks[6].words = 614400;
  board.fpga.joint_tables = true;
  board.fpga.pixel_cache = fpga::PixelCache::kWord;
  board.fpga.lanes = 10;
  const fpga::CoreConfig core = core_config(board);
  EXPECT_EQ(core.units, 40);
  EXPECT_EQ(core.rows, 4);
  EXPECT_EQ(core.cost, board.matcher.cost);
  EXPECT_TRUE(core.joint_tables);
  EXPECT_EQ(core.pixel_cache, fpga::PixelCache::kWord);
  EXPECT_EQ(core.lanes, 10);
}

TEST(BoardConfig, LaysBuffersOfOneBankOneBehindTheOther) {
  BoardConfig board;
  board.image = {8, 3};  // 6 words per image, 24 per table
  board.allocation.left_image = {"bank1", "bank0", "bank1"};
  board.allocation.right_image = {"bank0", "bank1", "bank2"};
  board.allocation.disparity = {"bank1", "bank1"};
  board.allocation.left_lut = "bank1";
  board.allocation.right_lut = "bank1";
  const fpga::BufferBases bases = buffer_bases(board);
  const auto base = fpga::registers::base;
  EXPECT_THAT(bases.left_images, ElementsAre(base(1, 0), base(0, 0), base(1, 6)));
  EXPECT_THAT(bases.right_images, ElementsAre(base(0, 6), base(1, 12), base(2, 0)));
  EXPECT_THAT(bases.disparities, ElementsAre(base(1, 18), base(1, 24)));
  EXPECT_EQ(bases.left_lut, base(1, 30));
  EXPECT_EQ(bases.right_lut, base(1, 54));
  const AddressRange last = buffers(board).back().range;
  EXPECT_EQ(last.first, fpga::registers::base_address(base(1, 54)));
  EXPECT_EQ(last.end, fpga::registers::base_address(base(1, 54 + 24)));
}

TEST(BoardConfig, LaysOutJointTablesAsOneBuffer) {
  BoardConfig board;
  board.fpga.joint_tables = true;
  board.allocation.right_lut = board.allocation.left_lut;
  EXPECT_EQ(buffers(board).size(), 7U);
  EXPECT_TRUE(core_config(board).right_table);
  const fpga::BufferBases bases = buffer_bases(board);
  EXPECT_TRUE(bases.has_joint_tables);
  EXPECT_EQ(bases.left_lut, fpga::registers::base(6, 0));
  EXPECT_FALSE(bases.right_lut.has_value());
  move_buffer(board, buffers(board).back(), "bank7");
  EXPECT_EQ(board.allocation.left_lut, "bank7");
  EXPECT_EQ(board.allocation.right_lut, "bank7");
}

TEST(BoardConfig, LaysOutNoTableThatDoesNotExist) {
  BoardConfig board;
  board.allocation.left_lut = std::nullopt;
  EXPECT_FALSE(buffer_bases(board).left_lut.has_value());
  EXPECT_TRUE(buffer_bases(board).right_lut.has_value());
  EXPECT_FALSE(core_config(board).left_table);
  EXPECT_TRUE(core_config(board).right_table);
}

}  // namespace
}  // namespace stereotlm::platform
