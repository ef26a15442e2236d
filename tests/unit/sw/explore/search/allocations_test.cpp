
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/search/allocation_search.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

BoardConfig fpl2003(const std::vector<std::string>& sets = {}) {
  return platform::load_board("fpl2003", sets);
}

std::vector<Placement> placements_of(const BoardConfig& board, int most_banks) {
  std::vector<Placement> all;
  for_each_placement(board, most_banks, [&all](const Placement& placement) { all.push_back(placement); });
  return all;
}

// Those of the board fpl2003.
std::vector<Placement> fitting_placements() {
  std::vector<Placement> all = placements_of(fpl2003(), 8);
  const auto is_too_large = [board = fpl2003()](const Placement& one) { return !fits(board, one); };
  all.erase(std::remove_if(all.begin(), all.end(), is_too_large), all.end());
  return all;
}

int banks_of(const BoardConfig& board) {
  std::set<std::string> names;
  for (const auto& buffer : platform::buffers(board)) names.insert(buffer.bank);
  return static_cast<int>(names.size());
}

TEST(Placements, AreTheSetPartitionsIfAllBanksAreEqual) {
  const std::vector<std::uint64_t> partitions_into_at_most = {1, 128, 1094, 2795, 3845, 4111, 4139, 4140};
  for (int banks = 1; banks <= 8; ++banks) {
    EXPECT_EQ(placements_of(fpl2003(), banks).size(),
              partitions_into_at_most[static_cast<std::size_t>(banks) - 1]);
  }
}

// The first bank is SDRAM: it is the only one of its kind, and then one of two.
TEST(Placements, TellSdramApartByItsTiming) {
  BoardConfig board = fpl2003();
  board.allocation.left_image = board.allocation.right_image = board.allocation.disparity = {"bank0"};
  board.allocation.right_lut.reset();
  EXPECT_EQ(placements_of(board, 1).size(), 1U);
  board.banks[0].kind = memory::BankKind::kSdram;
  board.banks[0].sdram = memory::SdramTiming();
  EXPECT_EQ(placements_of(board, 1).size(), 2U);
  EXPECT_FALSE(frames_are_independent(board));
  board.banks[1] = {"bank1", board.banks[0].words, board.banks[0].kind, 0, board.banks[0].sdram};
  EXPECT_EQ(placements_of(board, 1).size(), 2U);
  board.banks[1].sdram->row_words = 512;
  EXPECT_EQ(placements_of(board, 1).size(), 3U);
}

TEST(Placements, FitIfEachBankHoldsItsBuffers) {
  // Two tables of 307,200 words do not fit into 524,288; a table and two buffers of 76,800 do.
  EXPECT_FALSE(fits(fpl2003(), {0, 1, 2, 3, 4, 5, 6, 6}));
  EXPECT_TRUE(fits(fpl2003(), {0, 0, 1, 1, 2, 2, 0, 1}));
  EXPECT_FALSE(fits(fpl2003(), {0, 0, 0, 1, 2, 2, 0, 1}));
}

// The test lists all ways to put five buffers into four banks, of which a and c are equal.
TEST(Placements, AreVisitedOnceForEachExchangeOfEqualBanks) {
  for (const char* const banks :
       {"{a: {}, b: {words: 1048576}, c: {}, d: {kind: zbt_flow_through}}",
        "{a: {kind: sync_burst, turnaround_cycles: 2}, b: {kind: sync_burst, turnaround_cycles: 1}, "
        "c: {kind: sync_burst, turnaround_cycles: 2}, d: {}}"}) {
    const BoardConfig board = fpl2003({std::string("ssram.banks=") + banks,
                                       "allocation={left_image: a, right_image: a, disparity: [a, b], "
                                       "left_lut: c, right_lut: none}"});
    ASSERT_EQ(platform::buffers(board).size(), 5U);
    for (int most_banks = 1; most_banks <= 4; ++most_banks) {
      std::set<Placement> expected;
      for (int code = 0; code < 1024; ++code) {
        Placement placement;
        for (int i = 0; i < 5; ++i) placement.push_back(code >> (2 * i) & 3);
        if (banks_used(placement) > most_banks) continue;
        Placement exchanged = placement;
        for (int& bank : exchanged) bank = bank == 0 ? 2 : bank == 2 ? 0 : bank;
        expected.insert(std::min(placement, exchanged));
      }
      const auto found = placements_of(board, most_banks);
      EXPECT_EQ(std::set<Placement>(found.begin(), found.end()), expected) << banks << ' ' << most_banks;
      EXPECT_EQ(found.size(), expected.size()) << "each once";
    }
  }
}

TEST(Placements, AreWrittenIntoTheBoard) {
  EXPECT_EQ(allocation_text(placed(fpl2003(), {0, 1, 2, 2, 3, 4, 5, 0})),
            "left_image bank0 bank1, right_image bank2 bank2, disparity bank3 bank4, left_lut bank5, "
            "right_lut bank0");
  EXPECT_EQ(allocation_text(placed(fpl2003({"allocation.left_lut=none"}), {0, 1, 2, 2, 3, 4, 0})),
            "left_image bank0 bank1, right_image bank2 bank2, disparity bank3 bank4, right_lut bank0");
}

TEST(Placements, HaveOneBufferForJointTables) {
  const BoardConfig board = fpl2003({"fpga.tables=joint", "allocation.right_lut=bank6"});
  const std::string text =
      "left_image bank0 bank1, right_image bank2 bank2, disparity bank3 bank4, left_lut bank5";
  EXPECT_EQ(allocation_text(placed(board, {0, 1, 2, 2, 3, 4, 5})), text);
  EXPECT_EQ(placed(board, {0, 1, 2, 2, 3, 4, 5}).allocation.right_lut, "bank5");
  const BoardConfig frame = board_of_frame(board, {6, 7, 6, 5, 4, 4, 3}, 1);
  EXPECT_EQ(allocation_text(frame), "left_image bank0, right_image bank1, disparity bank2, left_lut bank3");
  EXPECT_TRUE(platform::problems(frame).empty());
}

TEST(BoardOfFrame, HasTheBuffersOfTheFrameInTheFirstBanksThatAreEqual) {
  const Placement placement = {6, 7, 6, 5, 4, 4, 3, 7};
  const auto text_of = [&placement](const BoardConfig& board, std::uint64_t frame) {
    return allocation_text(board_of_frame(board, placement, frame));
  };
  EXPECT_EQ(board_of_frame(fpl2003(), placement, 0).name, "one frame of fpl2003");
  EXPECT_EQ(text_of(fpl2003(), 0),
            "left_image bank0, right_image bank0, disparity bank1, left_lut bank2, right_lut bank3");
  EXPECT_EQ(text_of(fpl2003(), 1),
            "left_image bank0, right_image bank1, disparity bank2, left_lut bank3, right_lut bank0");
  EXPECT_EQ(text_of(fpl2003({"ssram.banks.bank0.kind=zbt_flow_through"}), 0),
            "left_image bank1, right_image bank1, disparity bank2, left_lut bank3, right_lut bank4");
}

// A bound that rules nothing out.
double no_bound(const BoardConfig& /*board*/) { return 1e9; }

AllocationSearch core_search(const BoardConfig& board, int most_banks) {
  return AllocationSearch(board, most_banks, {}, no_bound);
}

TEST(AllocationSearch, NeedsAFrameForEachWayInWhichTheBuffersOfAFrameShareBanks) {
  const AllocationSearch search = core_search(fpl2003(), 8);
  EXPECT_TRUE(search.by_frames());
  EXPECT_EQ(search.placements(), 4140U);
  EXPECT_EQ(search.fitting(), 2507U);
  EXPECT_EQ(search.size(), 35U);
  EXPECT_EQ(search.next().size(), 35U);
  EXPECT_EQ(search.most_left(), 35U);
  EXPECT_EQ(search.point(0).run.frames, 1U);
  EXPECT_EQ(AllocationSearch(fpl2003(), 8, {false, 4, ""}, no_bound).point(0).run.frames, 1U);
  EXPECT_EQ(core_search(fpl2003({"ssram.default.words=2097152"}), 8).size(), 52U)
      << "the set partitions of five buffers, if a bank holds everything";
  EXPECT_EQ(core_search(fpl2003({"fpga.arbitration=age"}), 8).size(), 35U);
}

TEST(AllocationSearch, RunsEachPlacementIfFramesAreNotIndependent) {
  for (const char* const set :
       {"fpga.arbitration=round_robin", "ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 1}"}) {
    const AllocationSearch core = core_search(fpl2003({set}), 3);
    EXPECT_FALSE(core.by_frames());
    EXPECT_EQ(core.size(), core.fitting());
    EXPECT_EQ(core.point(0).run.frames, 2U);
  }
  const AllocationSearch computer(fpl2003(), 3, {true, 0, ""}, no_bound);
  EXPECT_EQ(computer.size(), computer.fitting());
  EXPECT_EQ(computer.point(0).run.frames, 2 + kSteadyFrames);  // a turn of two is warm-up
}

// What the test expects of the placements with one number of banks.
struct Expected {
  std::uint64_t placements = 0;
  std::uint64_t failed = 0;
  std::uint64_t tied = 0;  // with the highest rate
  double highest = 0;
  Placement witness;  // the first of them

  void take(double rate, const Placement& placement) {
    if (rate > highest) {
      highest = rate;
      tied = 0;
      witness = placement;
    }
    tied += rate == highest ? 1 : 0;
  }
};

// Made-up cycles: a frame takes longer if its buffers share banks, and one of the boards fails.
TEST(AllocationSearch, ByFramesFindsTheBestPlacementsWithoutFailedFrames) {
  AllocationSearch search = core_search(fpl2003(), 8);
  const std::string failing = allocation_text(*search.point(1).board);
  const auto cycles_of = [](const BoardConfig& frame) {
    return 1000 * (6 - static_cast<std::uint64_t>(banks_of(frame)));
  };
  std::map<int, Expected> expected;  // [banks]
  for (const Placement& placement : fitting_placements()) {
    Expected& of_banks = expected[banks_used(placement)];
    ++of_banks.placements;
    const BoardConfig frames[] = {board_of_frame(fpl2003(), placement, 0),
                                  board_of_frame(fpl2003(), placement, 1)};
    if (allocation_text(frames[0]) == failing || allocation_text(frames[1]) == failing) {
      ++of_banks.failed;
    } else {
      of_banks.take(40e6 * 2 / static_cast<double>(cycles_of(frames[0]) + cycles_of(frames[1])), placement);
    }
  }
  for (const std::size_t number : search.next()) {
    AllocationOutcome outcome;
    outcome.cycles = cycles_of(*search.point(number).board);
    if (number == 1) outcome = {0, 0, 0, false, "no slot consumed"};
    search.record(number, outcome);
  }
  EXPECT_TRUE(search.next().empty());
  EXPECT_EQ(search.most_left(), 0U);
  EXPECT_EQ(search.first_failure(), failing + ": no slot consumed");
  const auto all = search.best();
  ASSERT_EQ(all.size(), expected.size());
  for (const BestPlacement& best : all) {
    EXPECT_EQ(best.placements, expected[best.banks].placements);
    EXPECT_EQ(best.tied, expected[best.banks].tied);
    EXPECT_EQ(best.outcome.frames_per_second, expected[best.banks].highest);
    EXPECT_EQ(best.witness, expected[best.banks].witness);
    EXPECT_EQ(best.failed, expected[best.banks].failed);
    EXPECT_EQ(best.known, best.placements);
    EXPECT_EQ(best.outcome.frames_per_second, 40e6 * 2 / static_cast<double>(best.outcome.cycles));
  }
  EXPECT_GT(all.front().failed, 0U);
  EXPECT_EQ(all.back().outcome.cycles, 2000U) << "a bank for each buffer of a frame";
}

TEST(AllocationSearch, ByFramesKnowsAPlacementOnceAllItsFramesAreSimulated) {
  AllocationSearch search = core_search(fpl2003(), 8);
  const auto bound_of = [](const BoardConfig& board) { return static_cast<double>(banks_of(board)); };
  for (const BestPlacement& best : search.best()) EXPECT_EQ(best.known, 0U);
  EXPECT_EQ(search.open_bounds(bound_of),
            (std::map<int, double>{{3, 3}, {4, 4}, {5, 5}, {6, 6}, {7, 7}, {8, 8}}));
  // The board of both frames of a placement with a bank for each buffer.
  const std::string apart = allocation_text(board_of_frame(fpl2003(), {0, 1, 2, 3, 4, 5, 6, 7}, 0));
  for (const std::size_t number : search.next()) {
    if (allocation_text(*search.point(number).board) == apart) search.record(number, {2000, 0, 0, false, ""});
  }
  const BestPlacement most_banks = search.best().back();
  EXPECT_EQ(most_banks.known, 1U);
  EXPECT_EQ(most_banks.outcome.frames_per_second, 40e6 / 2000);
  EXPECT_EQ(search.best().front().known, 0U);
  EXPECT_EQ(search.open_bounds(bound_of).count(8), 0U);
  EXPECT_EQ(search.open_bounds(bound_of).at(3), 3);
}

// Made-up runs of a computer, with rates from 10 to 20 frames/s and uncertainties up to 1 frame/s. The bounds
// are above the least possible rates by up to a tenth.
class ComputerSearch : public ::testing::Test {
 protected:
  static std::size_t mixed(const BoardConfig& board) {
    return std::hash<std::string>()(allocation_text(board));
  }
  static AllocationOutcome outcome_of(const BoardConfig& board) {
    const double rate = 10 + static_cast<double>(mixed(board) % 101) / 10;
    const std::size_t fate = mixed(board) / 10100 % 20;
    const double uncertainty = static_cast<double>(mixed(board) / 202000 % 11) / 10;
    return {1000, rate, uncertainty, fate < 2, fate == 2 ? "no slot consumed" : ""};
  }
  // The least rate that the placement can have.
  static double least_of(const BoardConfig& board) {
    const AllocationOutcome outcome = outcome_of(board);
    return outcome.frames_per_second - outcome.uncertainty;
  }
  static double bound_of(const BoardConfig& board) {
    return least_of(board) * (1 + static_cast<double>(mixed(board) / 101 % 100) / 1000);
  }
  static bool counts(const AllocationOutcome& outcome) {
    return !outcome.loses_pixels && outcome.failure.empty();
  }

  AllocationSearch search{fpl2003(), 8, {true, 0, ""}, bound_of};
};

TEST_F(ComputerSearch, FindsTheBestOfAllAndLeavesOutWhatIsSlower) {
  double least = 0;  // that the best has
  for (std::size_t number = 0; number < search.size(); ++number) {
    const BoardConfig board = *search.point(number).board;
    if (counts(outcome_of(board))) least = std::max(least, least_of(board));
  }
  double highest = 0;
  std::uint64_t tied = 0;
  for (std::size_t number = 0; number < search.size(); ++number) {
    const BoardConfig board = *search.point(number).board;
    const AllocationOutcome outcome = outcome_of(board);
    const double most = std::min(outcome.frames_per_second + outcome.uncertainty, bound_of(board));
    if (!counts(outcome) || most < least) continue;
    highest = std::max(highest, outcome.frames_per_second);
    ++tied;
  }
  std::size_t simulated = 0;
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    for (const std::size_t number : numbers) search.record(number, outcome_of(*search.point(number).board));
    simulated += numbers.size();
  }
  EXPECT_LT(simulated, search.size() / 2);
  const BestOfAll best = search.best_of_all().value();
  EXPECT_EQ(best.highest.frames_per_second, highest);
  EXPECT_EQ(best.tied, tied);
}

// At each time, the open bound or the best rate so far reaches the least rates of all placements that count.
TEST_F(ComputerSearch, HasABoundOfWhatIsNotKnownUntilItsEnd) {
  std::map<int, double> most;  // [banks]
  for (std::size_t number = 0; number < search.size(); ++number) {
    const BoardConfig board = *search.point(number).board;
    const AllocationOutcome outcome = outcome_of(board);
    if (counts(outcome)) most[banks_of(board)] = std::max(most[banks_of(board)], least_of(board));
  }
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    const std::map<int, double> open = search.open_bounds(bound_of);
    for (const BestPlacement& best : search.best()) {
      const double bound = open.count(best.banks) > 0 ? open.at(best.banks) : 0;
      EXPECT_GE(std::max(best.outcome.frames_per_second, bound), most[best.banks]);
      EXPECT_TRUE(best.known > 0 || bound > 0);
    }
    for (const std::size_t number : numbers) search.record(number, outcome_of(*search.point(number).board));
  }
  double most_failed = 0;
  for (std::size_t number = 0; number < search.size(); ++number) {
    const BoardConfig board = *search.point(number).board;
    if (outcome_of(board).failure.empty()) continue;
    most_failed = std::max(most_failed, bound_of(board));
  }
  double most_open = 0;
  for (const auto& [banks, bound] : search.open_bounds(bound_of)) most_open = std::max(most_open, bound);
  EXPECT_EQ(most_open, most_failed) << "at the end, only those that failed are open";
}

TEST_F(ComputerSearch, RefusesARateAboveItsBoundByMoreThanItsUncertaintyUnlessPixelsAreLost) {
  const std::size_t number = search.next().front();
  const double bound = bound_of(*search.point(number).board);
  search.record(number, {1000, 100, 100 - bound, false, ""});
  EXPECT_THROW(search.record(number, {1000, 100, 99.9 - bound, false, ""}), std::logic_error);
  search.record(number, {1000, 100, 0, true, ""});
}

// One placement to three banks, whose rate is known, has the bound 11 frames/s; all others have 10.
TEST(AllocationSearch, LeavesOutAPlacementOnlyIfItsBoundIsBelowTheLeastRateOfAnother) {
  const std::string known = allocation_text(placed(fpl2003(), {0, 0, 1, 1, 2, 2, 0, 1}));
  const auto bound_of = [&](const BoardConfig& board) {
    return allocation_text(board) == known ? 11.0 : 10.0;
  };
  for (const double least : {10.0, 10.01}) {
    AllocationSearch search(fpl2003(), 3, {true, 0, ""}, bound_of);
    const std::size_t first = search.next().front();
    ASSERT_EQ(allocation_text(*search.point(first).board), known);
    search.record(first, {1000, 10.5, 10.5 - least, false, ""});
    EXPECT_EQ(search.most_left(), least > 10 ? 0 : search.size() - 1);
    EXPECT_EQ(search.next().empty(), least > 10);
  }
}

}  // namespace
}  // namespace stereotlm::explore
