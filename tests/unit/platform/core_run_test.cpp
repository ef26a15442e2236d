#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/loop/core_loop.h"
#include "tests/support/scratch_folder.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::small_board;

// A worked value of contract section 2 or 7.
struct WorkedFrame {
  std::vector<std::string> sets;  // of the paper's board, without filter unless they name one
  std::uint64_t frame_cycles;
  std::vector<std::string> blame = {};  // "left_lut in bank0 by left_pixel: 2137602"
};

// Joint tables in bank0, all else in bank1, and the word cache.
std::vector<std::string> in_two_banks(std::vector<std::string> more = {}) {
  more.insert(more.end(),
              {"allocation={left_image: bank1, right_image: bank1, disparity: bank1, left_lut: bank0, "
               "right_lut: bank0}",
               "fpga.tables=joint", "fpga.pixel_cache=word"});
  return more;
}

const std::string kLog7 = "matcher.filter=log7";
const std::string kLineBuffer = "matcher.fetch=line_buffer";

TEST(CoreRun, GivesTheWorkedValues) {
  const WorkedFrame frames[] = {
      {{}, 2'150'995},
      {{kLog7}, 2'151'016},
      {{"matcher.window=5"}, 1'536'426},
      {{"matcher.window=5", kLog7}, 1'539'641},
      {{"matcher.window=9"}, 2'765'568},
      {{"matcher.window=11"}, 3'380'145},
      {{"matcher.window=13"}, 3'994'726},
      {{"matcher.window=15"}, 4'609'311},
      {{kLineBuffer}, 309'223},
      {{kLineBuffer, kLog7}, 311'146},
      {{"matcher.rows=2"}, 1'229'478},
      {{"matcher.rows=2", kLog7}, 1'229'502},
      {{"matcher.rows=4"}, 768'844},
      {{"matcher.rows=8"}, 615'568},
      {{"matcher.units=80"}, 2'150'995},
      {{"matcher.units=40"}, 4'301'969},
      {{"matcher.units=27"}, 6'452'943},
      {{"matcher.units=40", kLineBuffer}, 618'425},
      {{"allocation.left_lut=bank0"}, 4'288'597, {"left_lut in bank0 by left_pixel: 2137602"}},
      {{"allocation.left_lut=bank0", "fpga.arbitration=age"},
       4'287'317,
       {"left_lut in bank0 by left_pixel: 2136322", "left_pixel in bank0 by left_lut: 2135042"}},
      {{"allocation.disparity=[bank0, bank0]"}, 2'227'635, {"left_pixel in bank0 by result: 76640"}},
      {{"allocation.disparity=[bank0, bank0]", "ssram.banks.bank0.kind=qdr"}, 2'150'995},
      {{"allocation.disparity=[bank0, bank0]",
        "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}"},
       2'534'153,
       {"left_pixel in bank0 by result: 76640", "left_pixel in bank0 by turnaround: 306518",
        "result in bank0 by turnaround: 152960"}},
      {{"allocation.left_lut=bank0", "allocation.right_lut=bank2", "fpga.pixel_cache=word"},
       2'685'395,
       {"left_lut in bank0 by left_pixel: 534400", "right_lut in bank2 by right_pixel: 534400"}},
      {{kLog7, "fpga.result_delay_cycles=16", "fpga.pipeline_latency_cycles=0"}, 2'151'016},
      {{"matcher.rows=8", "fpga.result_delay_cycles=8"}, 692'368},
      {{kLineBuffer, "fpga.result_delay_cycles=16", "fpga.result_fifo_words=5"}, 324'598},
      {{kLineBuffer, "fpga.result_delay_cycles=16", "fpga.result_fifo_words=6"}, 309'239},
      {{"allocation.disparity=[bank0, bank0]", "fpga.result_delay_cycles=16"},
       2'227'629,
       {"left_pixel in bank0 by result: 76618"}},
      {in_two_banks(), 2'151'002, {"right_pixel in bank1 by left_pixel: 7"}},
      {in_two_banks({kLog7}), 2'151'023, {"right_pixel in bank1 by left_pixel: 7"}},
      {{"image={width: 64, height: 49}",
        "matcher={window: 5, disparities: 16, filter: none, fetch: line_buffer, lr_tolerance: 0}",
        "fpga.result_fifo_words=1", "fpga.arbitration=round_robin",
        "fpga.priority=[host, right_lut, left_lut, right_pixel, left_pixel, result]",
        "ssram.banks={bank0: {kind: qdr}}",
        "allocation={left_image: bank0, right_image: bank0, disparity: bank0, left_lut: bank0, right_lut: "
        "bank0}"},
       12'744,
       {"left_lut in bank0 by right_lut: 3136", "left_lut in bank0 by left_pixel: 3135",
        "left_lut in bank0 by right_pixel: 3135", "right_lut in bank0 by left_lut: 3135",
        "right_lut in bank0 by left_pixel: 3135", "right_lut in bank0 by right_pixel: 3135"}},
  };
  for (const WorkedFrame& frame : frames) {
    SCOPED_TRACE(frame.frame_cycles);
    std::vector<std::string> sets = frame.sets;
    const bool has_filter = std::any_of(sets.begin(), sets.end(), [](const std::string& set) {
      return set == kLog7 || set.rfind("matcher=", 0) == 0;
    });
    if (!has_filter) sets.emplace_back("matcher.filter=none");
    const BoardConfig board = load_board("fpl2003", sets);
    const Statistics statistics = run_core(board, identity_tables(board), 1);
    EXPECT_THAT(statistics.frame_cycles, ElementsAre(frame.frame_cycles));
    std::vector<std::string> blame;
    for (const BlameRow& row : statistics.blame)
      blame.push_back(row.port + " in " + row.bank + " by " + row.by + ": " + std::to_string(row.cycles));
    EXPECT_EQ(blame, frame.blame);
    EXPECT_THAT(statistics.failed, ElementsAre());
  }
}

// Contract section 8.
TEST(CoreRun, GivesTheWorkedValuesOfLanes) {
  const BoardConfig board = load_board("fpl2003", {"matcher.filter=none", "fpga.lanes=4"});
  EXPECT_THAT(run_core(board, identity_tables(board), 1).frame_cycles, ElementsAre(2'142'909));
}

TEST(CoreRun, GivesTheWorkedPortStates) {
  BoardConfig board = load_board("fpl2003", {"matcher.filter=none"});
  const PortStatistics table = run_core(board, identity_tables(board), 1).ports[0];
  EXPECT_EQ(table.grants, 2'142'720U);
  EXPECT_EQ(table.passed_cycles, 7'680U);
  EXPECT_EQ(table.idle_cycles, 579U);
  EXPECT_EQ(table.stall_cycles + table.blocked_cycles + table.starved_cycles, 0U);
  board = load_board("fpl2003", in_two_banks({"matcher.filter=none"}));
  const Statistics joint = run_core(board, identity_tables(board), 1);
  EXPECT_EQ(joint.ports[2].grants, 535'680U);
  EXPECT_EQ(joint.ports[2].passed_cycles, 1'614'720U);
  EXPECT_EQ(joint.ports[1].idle_cycles, joint.cycles);
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
  EXPECT_EQ(statistics.ports[fpga::kResultGroup].grants, std::uint64_t{1} << 24U);
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

TEST(CoreRun, GivesTheFiguresOfTheFramesSoFar) {
  const BoardConfig board = small_board();
  const Tables tables = identity_tables(board);
  CoreLoop core(board, tables);
  for (std::uint64_t frames = 1; frames <= 3; ++frames) {
    core.run_frame();
    EXPECT_EQ(core.counts().frame_cycles, run_core(board, tables, frames).frame_cycles);
    EXPECT_EQ(statistics_of(board, core.counts()).cycles, run_core(board, tables, frames).cycles);
  }
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
