#include "platform/core_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/support/scratch_folder.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::small_board;

// Contract section 2, worked values.
TEST(CoreRun, GivesTheWorkedValues) {
  const auto first_frame = [](const std::vector<std::string>& sets) {
    const BoardConfig board = load_board("fpl2003", sets);
    return run_core(board, identity_tables(board), 1).frame_cycles;
  };
  EXPECT_THAT(first_frame({}), ElementsAre(2151016));
  EXPECT_THAT(first_frame({"matcher.filter=none"}), ElementsAre(2150995));
  EXPECT_THAT(first_frame({"matcher.fetch=line_buffer"}), ElementsAre(311146));
  EXPECT_THAT(first_frame({"matcher.filter=none", "allocation.left_lut=bank0"}), ElementsAre(4288597));
  EXPECT_THAT(first_frame({"matcher.filter=none", "allocation.left_lut=bank0", "fpga.arbitration=age"}),
              ElementsAre(4287317));
  EXPECT_THAT(first_frame({"matcher.filter=none", "allocation.disparity=[bank0, bank0]",
                           "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}"}),
              ElementsAre(2534153));
}

// Contract section 7, worked values.
TEST(CoreRun, GivesTheWorkedValuesOfUnitsAndRows) {
  const auto first_frame = [](std::vector<std::string> sets, const char* filter = "none") {
    sets.push_back(std::string("matcher.filter=") + filter);
    const BoardConfig board = load_board("fpl2003", sets);
    return run_core(board, identity_tables(board), 1).frame_cycles;
  };
  EXPECT_THAT(first_frame({"matcher.rows=2"}), ElementsAre(1229478));
  EXPECT_THAT(first_frame({"matcher.rows=2"}, "log7"), ElementsAre(1229502));
  EXPECT_THAT(first_frame({"matcher.rows=4"}), ElementsAre(768844));
  EXPECT_THAT(first_frame({"matcher.rows=8"}), ElementsAre(615568));
  EXPECT_THAT(first_frame({"matcher.units=80"}), ElementsAre(2150995));
  EXPECT_THAT(first_frame({"matcher.units=40"}), ElementsAre(4301969));
  EXPECT_THAT(first_frame({"matcher.units=27"}), ElementsAre(6452943));
  EXPECT_THAT(first_frame({"matcher.units=40", "matcher.fetch=line_buffer"}), ElementsAre(618425));
}

// Uncontended: the latency of the first slot, the slots and the drain, the last writes, the pipeline.
TEST(CoreRun, RunsTheLargestImageWithTheLongestColumns) {
  const BoardConfig board =
      load_board("fpl2003-no-calibration", {"image={width: 8192, height: 8192}",
                                            "ssram.default.words=67108864", "fpga.result_fifo_words=64",
                                            "matcher={window: 31, disparities: 254, units: 127, rows: 16, "
                                            "filter: none, fetch: column, lr_tolerance: 0}"});
  const Statistics statistics = run_core(board, {}, 1);
  const std::uint64_t columns = std::uint64_t{8192} * 8192 / 16 + 254 - 1 + 15;
  EXPECT_THAT(statistics.frame_cycles, ElementsAre(2 + columns * (31 + 15) * 2 + 16 + 16));
  EXPECT_THAT(statistics.failed, ElementsAre());
  EXPECT_EQ(statistics.ports[fpga::kResultPort].grants, std::uint64_t{1} << 24U);
}

TEST(CoreRun, GivesTheWorkedValuesOfJointTablesAndTheWordCache) {
  const auto first_frame = [](std::vector<std::string> sets) {
    sets.emplace_back("fpga.pixel_cache=word");
    const BoardConfig board = load_board("fpl2003", sets);
    return run_core(board, identity_tables(board), 1).frame_cycles;
  };
  EXPECT_THAT(first_frame({"matcher.filter=none", "allocation.left_lut=bank0", "allocation.right_lut=bank2"}),
              ElementsAre(2685395));
  const std::string two_banks =
      "allocation={left_image: bank1, right_image: bank1, disparity: bank1, left_lut: bank0, right_lut: "
      "bank0}";
  EXPECT_THAT(first_frame({"matcher.filter=none", two_banks, "fpga.tables=joint"}), ElementsAre(2151002));
  EXPECT_THAT(first_frame({two_banks, "fpga.tables=joint"}), ElementsAre(2151023));
  EXPECT_THAT(
      first_frame({"matcher.filter=none", "matcher.fetch=line_buffer", two_banks, "fpga.tables=joint"}),
      ElementsAre(461811));
}

TEST(CoreRun, GivesTheWorkedValueOfOddTables) {
  const BoardConfig board = load_board(
      "fpl2003", {"image={width: 8, height: 48}",
                  "matcher={window: 5, disparities: 16, filter: none, fetch: column, lr_tolerance: 0}",
                  "fpga.pixel_cache=word", "allocation.left_lut=bank0"});
  kernels::RectificationTable table{8, 48, {}};
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool is_valid = (3 * x + 5 * y) % 11 != 0;
      table.entries.push_back(is_valid ? kernels::make_entry(x / 2, 3 * (y / 3)) : 0);
    }
  }
  EXPECT_THAT(run_core(board, {table, table}, 1).frame_cycles, ElementsAre(2257));
}

TEST(CoreRun, RefusesTablesAndBoardsThatDoNotFit) {
  BoardConfig board = small_board();
  Tables tables = identity_tables(board);
  EXPECT_THAT(message_of([&] { run_core(board, tables, 0); }), HasSubstr("frames = 0"));
  tables.right.reset();
  EXPECT_THAT(message_of([&] { run_core(board, tables, 1); }), HasSubstr("right table missing"));
  board.allocation.right_lut.reset();
  tables.left->entries[5] = 0x40000000U;
  EXPECT_THAT(message_of([&] { run_core(board, tables, 1); }), HasSubstr("left table: entry (5, 0)"));
  tables = identity_tables(board);
  tables.left->width *= 2;
  EXPECT_THAT(message_of([&] { run_core(board, tables, 1); }),
              HasSubstr("must be of the size of the images"));
  tables = identity_tables(board);
  board.allocation.left_lut.reset();
  EXPECT_THAT(message_of([&] { run_core(board, tables, 1); }), HasSubstr("left table given, but no buffer"));
  board.matcher.window = 4;
  EXPECT_THROW(run_core(board, {}, 1), std::invalid_argument);
}

TEST(CoreRun, RefusesJointTablesThatDoNotFit) {
  BoardConfig board = load_board("fpl2003", {"fpga.tables=joint", "allocation.right_lut=bank6"});
  Tables tables = identity_tables(board);
  tables.left->entries[0] = kernels::make_entry(256, 0);
  tables.right->entries[0] = kernels::make_entry(0, 128);
  EXPECT_EQ(message_of([&] { run_core(board, tables, 1); }),
            "left table: its displacements in x are 0..256, a range of 257: joint tables have 256; right "
            "table: its displacements in y are 0..128, a range of 129: joint tables have 128");
  tables.left->entries[0] = kernels::make_entry(255, 0);
  tables.right->entries[0] = kernels::make_entry(0, 127);
  EXPECT_NO_THROW(run_core(board, tables, 1));
  board.fpga.joint_tables = false;
  board.allocation.right_lut = "bank7";
  tables.left->entries[0] = kernels::make_entry(256, 0);
  EXPECT_NO_THROW(run_core(board, tables, 1));
}

TEST(CoreRun, EndsAFrameThatMakesNoProgress) {
  const BoardConfig board = small_board();
  EXPECT_THAT(message_of([&] { run_core(board, identity_tables(board), 1, 1); }),
              HasSubstr("frame 0 of the core: no slot consumed and no result written for 1 cycles"));
}

// Without tables and with latencies of one cycle, the matcher works in every cycle from the second one on.
TEST(CoreRun, TakesALongPassOrDrainForNoStall) {
  BoardConfig board = small_board();
  board.allocation.left_lut.reset();
  board.allocation.right_lut.reset();
  for (BankConfig& bank : board.banks) bank.kind = memory::BankKind::kZbtFlowThrough;
  board.matcher.disparities = 254;
  board.matcher.units = 1;
  const Statistics statistics = run_core(board, {}, 2, 2);
  EXPECT_EQ(statistics.frame_cycles.size(), 2U);
  EXPECT_THAT(message_of([&] { run_core(board, {}, 2, 1); }), HasSubstr("frame 0 of the core: "));
}

}  // namespace
}  // namespace stereotlm::platform
