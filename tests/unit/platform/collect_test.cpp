#include "platform/figures/collect.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "platform/config/board_area.h"
#include "platform/figures/bounds.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

using memory::ArbiterStats;

using std::uint64_t;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::kPipeline;
using testing::PreloadedRun;
using testing::small_board;

// tests/integration/core/random_boards_test.cpp compares the counters of banks and ports with those of the
// plain cycle loop.
class CollectStatistics : public ::testing::Test {
 protected:
  Statistics finish(uint64_t frames) {
    run.emplace(board, identity_tables(board), frames);
    return run->finish();
  }

  BoardConfig board = small_board();
  std::optional<PreloadedRun> run;
};

TEST_F(CollectStatistics, GivesTheFiguresOfTheFramesThatEnded) {
  const Statistics statistics = finish(2);
  const uint64_t frame = 4 + 16 * 6 * 3 + 9 + 1 + kPipeline;
  EXPECT_EQ(statistics.board, "fpl2003");
  EXPECT_EQ(statistics.fidelity, "cycle");
  EXPECT_EQ(statistics.frames, 2U);
  EXPECT_EQ(statistics.frame_cycles, (std::vector<uint64_t>{frame, frame}));
  EXPECT_EQ(statistics.cycles, 2 * (frame - kPipeline));
  EXPECT_DOUBLE_EQ(statistics.frames_per_second.core, 40e6 / static_cast<double>(frame));
  EXPECT_EQ(statistics.bound.core, core_bound(board, identity_tables(board)).core);
  EXPECT_EQ(statistics.bound.core_limited_by, "matcher");
  EXPECT_GT(statistics.area.slices, 0);
  EXPECT_EQ(statistics.area.slices, area_of(board).slices);
  EXPECT_EQ(statistics.area.block_rams, area_of(board).block_rams);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
}

TEST_F(CollectStatistics, GivesTheUseOfEveryBankInTheOrderOfTheBoard) {
  board.banks.push_back({"spare", 16});
  const Statistics statistics = finish(2);
  const auto cycles = static_cast<double>(statistics.cycles);
  ASSERT_EQ(statistics.banks.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    const BankStatistics& bank = statistics.banks[i];
    EXPECT_EQ(bank.name, board.banks[i].name);
    EXPECT_EQ(bank.busy_cycles > 0, i < 8);
    EXPECT_DOUBLE_EQ(bank.utilization, static_cast<double>(bank.busy_cycles) / cycles);
    EXPECT_DOUBLE_EQ(bank.megabytes_per_second, 4 * static_cast<double>(bank.busy_cycles) * 40 / cycles);
  }
}

TEST_F(CollectStatistics, CountsACycleWithAReadAndAWriteAsOneBusyCycle) {
  board.banks[0].kind = memory::BankKind::kQdr;
  board.allocation.left_image = board.allocation.right_image = board.allocation.disparity = {"bank0"};
  const Statistics statistics = finish(2);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
  const BankStatistics& bank = statistics.banks[0];
  EXPECT_EQ(bank.ports, 2);
  EXPECT_EQ(statistics.banks[1].ports, 1);
  EXPECT_LT(bank.busy_cycles, bank.reads + bank.writes);
  EXPECT_EQ(bank.idle_cycles, statistics.cycles - bank.busy_cycles);
  for (const BlameRow& row : statistics.blame) EXPECT_NE(row.by, "result");
}

TEST_F(CollectStatistics, HasNoFiguresBeforeTheFirstFrame) {
  const Statistics statistics = finish(0);
  EXPECT_EQ(statistics.frames, 0U);
  EXPECT_EQ(statistics.cycles, 0U);
  EXPECT_EQ(statistics.frames_per_second.core, 0);
  EXPECT_EQ(statistics.banks.at(0).utilization, 0);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
}

// Each identity is broken alone, by one counter of a valid run.
TEST_F(CollectStatistics, FindsEachIdentityThatDoesNotHold) {
  const Statistics valid = finish(1);
  EXPECT_THAT(valid.failed, IsEmpty());
  const uint64_t cycles = valid.cycles;
  const auto expect_failed = [&](const std::string& line, const auto& change) {
    BoardCounters counters = counters_of(run->system.board);
    change(counters);
    EXPECT_THAT(collect_statistics(board, run->tables, run->system.board, counters).failed,
                ElementsAre(line));
  };
  for (std::size_t port = 0; port < fpga::kGroupCount; ++port) {
    const std::string name = fmt::format("port {}: ", fpga::kPortGroups[port].name);
    const uint64_t grants = valid.ports[port].grants;
    expect_failed(
        fmt::format("{}sum of its states = {}, but cycles = {}", name, cycles + 1, cycles),
        [port](BoardCounters& counters) { counters.ports[port].add(fpga::Intent::kStarved, false); });
    for (const std::size_t by : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3},
                                 std::size_t{4}, std::size_t{5}, memory::kTurnaround}) {
      expect_failed(name + "stall_cycles = 0, but blamed by the arbiters = 1",
                    [port, by](BoardCounters& counters) {
                      ArbiterStats& arbiter = counters.banks[1].arbiter;
                      arbiter.add(arbiter.blame_place(port, by), 1);
                    });
    }
    expect_failed(fmt::format("{}grants = {}, but given by the arbiters = {}", name, grants, grants + 1),
                  [port](BoardCounters& counters) {
                    ArbiterStats& arbiter = counters.banks[1].arbiter;
                    arbiter.add(arbiter.grants_place(port), 1);
                  });
  }
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const std::string name = fmt::format("bank {}: ", board.banks[bank].name);
    const uint64_t accesses = valid.banks[bank].busy_cycles;
    const std::string states = name + "busy + turnaround + idle cycles = {}, but cycles = {}";
    expect_failed(fmt::format(states, cycles + 1, cycles), [bank](BoardCounters& counters) {
      counters.banks[bank].arbiter.add(ArbiterStats::kIdle, 1);
    });
    expect_failed(fmt::format(states, cycles + 1, cycles), [bank](BoardCounters& counters) {
      counters.banks[bank].arbiter.add(ArbiterStats::kTurnaroundCycles, 1);
    });
    expect_failed(
        fmt::format("{}accesses = {}, but granted by its arbiter = {}", name, accesses + 1, accesses),
        [bank](BoardCounters& counters) { ++counters.banks[bank].accesses; });
    expect_failed(
        fmt::format("{}accesses = {}, but granted by its arbiter = {}", name, accesses, accesses + 1),
        [bank](BoardCounters& counters) { counters.banks[bank].arbiter.add(ArbiterStats::kUncounted, 1); });
  }
  const auto slots = [](const std::string& what, int count) {
    return fmt::format("{} = {}, but slots of the sequence = 288", what, count);
  };
  expect_failed(slots("left lane: slots consumed", 289), [](BoardCounters& found) { ++found.consumed[0]; });
  expect_failed(slots("right lane: slots consumed", 287), [](BoardCounters& found) { --found.consumed[1]; });
  expect_failed(slots("left lane: slots issued", 289), [](BoardCounters& found) { ++found.issued[0]; });
  expect_failed(slots("right lane: slots issued", 287), [](BoardCounters& found) { --found.issued[1]; });
  expect_failed("result packer: words = 25, but words of the images = 24",
                [](BoardCounters& found) { ++found.packed_words; });
  expect_failed("result writer: words = 23, but words of the images = 24",
                [](BoardCounters& found) { --found.written_words; });
}

TEST_F(CollectStatistics, ReportsAFrameThatIsShorterThanItsBound) {
  // The left table of the run has no valid entries. The tables of the bound have only valid ones.
  board.allocation.left_lut = "bank0";
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  Tables empty = identity_tables(board);
  std::fill(empty.left->entries.begin(), empty.left->entries.end(), 0U);
  run.emplace(board, empty, 1);
  EXPECT_EQ(run->finish().failed, std::vector<std::string>{});
  const Statistics statistics = collect_statistics(board, identity_tables(board), run->system.board);
  const uint64_t bound = turn_bounds(board, frame_accesses(board, identity_tables(board))).at(0).cycles;
  ASSERT_LT(statistics.frame_cycles.at(0), bound);
  EXPECT_THAT(statistics.failed, ElementsAre(fmt::format("bound of bank bank0 = {}, but frame_cycles[0] = {}",
                                                         bound, statistics.frame_cycles[0])));
}

}  // namespace
}  // namespace stereotlm::platform
