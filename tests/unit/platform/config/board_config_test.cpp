#include "platform/config/board_config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

using Problems = std::vector<std::string>;

Problems problems_with(const std::function<void(BoardConfig&)>& change) {
  BoardConfig board;
  change(board);
  return problems(board);
}

TEST(BoardConfig, HasNoProblemsByDefault) { EXPECT_EQ(problems(BoardConfig()), Problems{}); }

TEST(BoardConfig, ReportsEveryBrokenRuleInTheOrderOfTheFields) {
  BoardConfig board;
  board.name = "a\nb";
  board.image.width = 642;
  board.cameras.frame_rate_hz = std::nan("");
  board.capture.fifo_trigger_words = 141;
  board.pci.clock_mhz = std::numeric_limits<double>::infinity();
  board.pci.load = PciLoadConfig{0, -0.5, std::nan(""), 1000000.5};
  board.fpga.device = "xc4vlx25";
  board.fpga.arbiter.priority[0] = fpga::kResultPort;
  board.banks[1].name = "bank0";
  board.banks[2].name = "none";
  board.banks[3].words = 0;
  board.banks[4].kind = memory::BankKind::kSyncBurst;
  board.banks[5].turnaround_cycles = 3;
  board.allocation.disparity = {};
  board.matcher.filter->shift = 32;
  board.matcher.lr_tolerance = 254;
  board.matcher.units = 255;
  board.matcher.rows = 17;
  board.matcher.cost = {kernels::CostKind::kCensus, 4};
  board.fpga.pixel_cache = static_cast<fpga::PixelCache>(2);
  const std::string name_problem =
      "name = a\nb: a text of one or more characters without control characters; quoted if it could be read "
      "as a "
      "number, a truth value or null";
  const std::string priority_problem =
      "fpga.priority = [result, result, left_pixel, right_pixel, left_lut, right_lut]: a list that names "
      "each port once: left_lut, right_lut, left_pixel, right_pixel, result, host";
  EXPECT_EQ(problems(board),
            (Problems{name_problem,
                      "image.width = 642: 4..8192, a multiple of 4",
                      "cameras.frame_rate_hz = nan: 0.1..1000",
                      "capture.fifo_trigger_words = 141: 1..fifo_words, which is 140",
                      "pci.clock_mhz = inf: 1..1000",
                      "pci.load.burst_words = 0: 1..1024",
                      "pci.load.interval_us = -0.5: 0..1000000000",
                      "pci.load.first_us = nan: 0..1000000000",
                      "pci.load.access_us = 1000000.5: 0..1000000",
                      "fpga.device = xc4vlx25: must be one of xc2v1000, xc2v1500, xc2v2000, xc2v3000, "
                      "xc2v4000, xc2v6000 or xc2v8000",
                      priority_problem,
                      "fpga.pixel_cache = 2: must be one of none or word",
                      "ssram.banks = bank0: repeated name",
                      "ssram.banks = none: a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none",
                      "ssram.banks.bank3.words = 0: 1..67108864",
                      "ssram.banks.bank4.turnaround_cycles = 0: 1..16 for sync_burst",
                      "ssram.banks.bank5.turnaround_cycles = 3: 0 for zbt_pipelined",
                      "allocation.disparity = []: a bank, or a list of 1 to 3 banks",
                      "matcher.filter.shift = 32: must be 0..31",
                      "matcher.lr_tolerance = 254: 0..253 or off",
                      "matcher.units = 255: 1..254 or all",
                      "matcher.rows = 17: 1..16",
                      "matcher.cost.census = 4: 3, 5 or 7"}));
}

TEST(BoardConfig, DiffersInEachFieldOfALoad) {
  BoardConfig board;
  board.pci.load = PciLoadConfig{1, 2, 3, 4};
  BoardConfig other = board;
  EXPECT_EQ(other, board);
  for (const PciLoadConfig& load : {PciLoadConfig{5, 2, 3, 4}, {1, 5, 3, 4}, {1, 2, 5, 4}, {1, 2, 3, 5}}) {
    other.pci.load = load;
    EXPECT_NE(other, board);
  }
}

TEST(BoardConfig, RefusesEnumeratorsAndNamesThatDoNotExist) {
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.cameras.trigger = static_cast<CameraTrigger>(2); }),
            Problems{"cameras.trigger = 2: must be one of free_running or on_demand"});
  EXPECT_EQ(
      problems_with([](BoardConfig& b) { b.banks[0].kind = static_cast<memory::BankKind>(4); }),
      Problems{
          "ssram.banks.bank0.kind = 4: must be one of zbt_pipelined, zbt_flow_through, sync_burst or qdr"});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.fpga.arbiter.policy = "lottery"; }),
            Problems{"fpga.arbitration = lottery: must be one of fixed_priority, round_robin or age"});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.fpga.arbiter.priority[0] = 6; }).size(), 1U);
}

TEST(BoardConfig, ChecksTheRulesBetweenKeys) {
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.allocation.left_lut = "bank9"; }),
            Problems{"allocation.left_lut = bank9: not a bank of this board; nearest: bank0"});
  EXPECT_EQ(
      problems_with([](BoardConfig& b) { b.allocation.left_image.pop_back(); }),
      Problems{"allocation.right_image = [bank2, bank3]: must be as long as left_image, which is [bank0]"});
  EXPECT_EQ(
      problems_with([](BoardConfig& b) { b.banks[6].words = 307199; }),
      Problems{"ssram.banks.bank6.words = 307199: 1 words missing, its buffers (left_lut) need 307200"});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.banks[6].words = 307200; }), Problems{});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.banks.clear(); }),
            Problems{"ssram.banks = 0 banks: a map of 1..64 banks"});
}

TEST(BoardConfig, ChecksTheRulesOfOptionalKeys) {
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.matcher.units = 81; }),
            Problems{"matcher.units = 81: 1..disparities, which is 80, or all"});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.matcher.units = 80; }), Problems{});
  EXPECT_EQ(
      problems_with([](BoardConfig& b) { b.matcher.rows = 9; }),
      Problems{"fpga.result_fifo_words = 8: at least 9, a word for each of the rows that are computed at "
               "once; or fewer matcher.rows"});
  EXPECT_EQ(
      problems_with([](BoardConfig& b) { b.fpga.joint_tables = true; }),
      Problems{"allocation.right_lut = bank7: must be bank6, the bank of left_lut, because fpga.tables is "
               "joint; or set fpga.tables to separate"});
  EXPECT_EQ(problems_with([](BoardConfig& b) { b.matcher.cost.census_size = 3; }),
            Problems{"matcher.cost.census = 3: 0 unless the cost is census"});
}

TEST(BoardConfig, DiffersInEachOptionalKey) {
  const std::vector<std::function<void(BoardConfig&)>> changes = {
      [](BoardConfig& b) { b.matcher.units = 80; }, [](BoardConfig& b) { b.matcher.rows = 2; },
      [](BoardConfig& b) {
        b.matcher.cost = {kernels::CostKind::kSsd, 0};
      },
      [](BoardConfig& b) { b.fpga.joint_tables = true; },
      [](BoardConfig& b) { b.fpga.pixel_cache = fpga::PixelCache::kWord; }};
  for (std::size_t number = 0; number < changes.size(); ++number) {
    BoardConfig board;
    changes[number](board);
    EXPECT_NE(board, BoardConfig()) << number;
  }
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
  const fpga::CoreConfig core = core_config(board);
  EXPECT_EQ(core.units, 40);
  EXPECT_EQ(core.rows, 4);
  EXPECT_EQ(core.cost, board.matcher.cost);
  EXPECT_TRUE(core.joint_tables);
  EXPECT_EQ(core.pixel_cache, fpga::PixelCache::kWord);
}

TEST(BoardConfig, LaysBuffersOfOneBankOneBehindTheOther) {
  BoardConfig board;
  board.image = {8, 3};  // 6 words per image, 24 per table
  board.allocation.left_image = {"bank1", "bank0", "bank1"};
  board.allocation.right_image = {"bank0", "bank1", "bank2"};
  board.allocation.disparity = {"bank1", "bank1"};
  board.allocation.left_lut = "bank1";
  board.allocation.right_lut = "bank1";
  const BufferLayout layout = layout_buffers(board);
  const auto expect_place = [](const BufferPlace& place, int bank, std::uint32_t first_word) {
    EXPECT_EQ(place.bank, bank);
    EXPECT_EQ(place.first_word, first_word);
  };
  ASSERT_EQ(layout.left_image.size(), 3U);
  ASSERT_EQ(layout.right_image.size(), 3U);
  ASSERT_EQ(layout.disparity.size(), 2U);
  expect_place(layout.left_image[0], 1, 0);
  expect_place(layout.left_image[1], 0, 0);
  expect_place(layout.left_image[2], 1, 6);
  expect_place(layout.right_image[0], 0, 6);
  expect_place(layout.right_image[1], 1, 12);
  expect_place(layout.right_image[2], 2, 0);
  expect_place(layout.disparity[0], 1, 18);
  expect_place(layout.disparity[1], 1, 24);
  expect_place(layout.left_lut.value(), 1, 30);
  expect_place(layout.right_lut.value(), 1, 54);
}

TEST(BoardConfig, LaysOutJointTablesAsOneBuffer) {
  BoardConfig board;
  board.fpga.joint_tables = true;
  board.allocation.right_lut = board.allocation.left_lut;
  EXPECT_EQ(buffers(board).size(), 7U);
  const BufferLayout layout = layout_buffers(board);
  EXPECT_EQ(layout.left_lut.value().bank, 6);
  EXPECT_FALSE(layout.right_lut.has_value());
  EXPECT_TRUE(core_config(board).right_table);
  const fpga::BufferBases bases = buffer_bases(board);
  EXPECT_TRUE(bases.has_joint_tables);
  EXPECT_FALSE(bases.right_lut.has_value());
  EXPECT_EQ(buffer_ranges(board).size(), 7U);
  move_buffer(board, buffers(board).back(), "bank7");
  EXPECT_EQ(board.allocation.left_lut, "bank7");
  EXPECT_EQ(board.allocation.right_lut, "bank7");
  board.banks[7].words = 307199;
  EXPECT_THROW(layout_buffers(board), std::invalid_argument);
}

TEST(BoardConfig, LaysOutNoTableThatDoesNotExist) {
  BoardConfig board;
  board.allocation.left_lut = std::nullopt;
  EXPECT_FALSE(layout_buffers(board).left_lut.has_value());
  EXPECT_TRUE(layout_buffers(board).right_lut.has_value());
  EXPECT_FALSE(core_config(board).left_table);
  EXPECT_TRUE(core_config(board).right_table);
}

TEST(BoardConfig, IsNotLaidOutWithProblems) {
  BoardConfig board;
  board.allocation.left_lut = "bank9";
  EXPECT_THROW(layout_buffers(board), std::invalid_argument);
  EXPECT_THROW(core_config(board), std::invalid_argument);
  board = BoardConfig();
  board.banks[6].words = 307199;
  EXPECT_THROW(layout_buffers(board), std::invalid_argument);
  board.banks[6].words = 307200;
  EXPECT_NO_THROW(layout_buffers(board));
}

}  // namespace
}  // namespace stereotlm::platform
