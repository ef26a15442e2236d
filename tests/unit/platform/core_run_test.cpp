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
