#include "sw/explore/search/allocations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_rules.h"
#include "platform/config/board_yaml.h"
#include "sw/explore/search/allocation_search.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;
using ::testing::ElementsAre;

std::vector<Placement> placements_of(const BoardConfig& board, int most_banks) {
  std::vector<Placement> all;
  for_each_placement(board, most_banks, [&all](const Placement& placement) { all.push_back(placement); });
  return all;
}

BoardConfig fpl2003(const std::vector<std::string>& sets = {}) {
  return platform::load_board("fpl2003", sets);
}

TEST(Placements, AreTheSetPartitionsWhereBanksAreAlike) {
  const std::vector<std::uint64_t> partitions_into_at_most = {1, 128, 1094, 2795, 3845, 4111, 4139, 4140};
  for (int banks = 1; banks <= 8; ++banks) {
    EXPECT_EQ(placements_of(fpl2003(), banks).size(),
              partitions_into_at_most[static_cast<std::size_t>(banks) - 1]);
  }
}

TEST(Placements, ThatFitAreTold) {
  const BoardConfig board = fpl2003();
  const auto all = placements_of(board, 8);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [&](const Placement& one) { return fits(board, one); }),
            2507);
  // Two tables of 307,200 words do not fit into 524,288; a table and two buffers of 76,800 do.
  EXPECT_FALSE(fits(board, {0, 1, 2, 3, 4, 5, 6, 6}));
  EXPECT_TRUE(fits(board, {0, 0, 1, 1, 2, 2, 0, 1}));
  EXPECT_FALSE(fits(board, {0, 0, 0, 1, 2, 2, 0, 1}));
}

// Every way to put the buffers into banks, and which of them are the same but for an exchange of banks that
// are alike.
TEST(Placements, AreOneOfEachKindOfWayWithBanksThatDiffer) {
  // Banks a and c are alike.
  for (const char* const banks :
       {"{a: {}, b: {words: 1048576}, c: {}, d: {kind: zbt_flow_through}}",
        "{a: {kind: sync_burst, turnaround_cycles: 2}, b: {kind: sync_burst, turnaround_cycles: 1}, "
        "c: {kind: sync_burst, turnaround_cycles: 2}, d: {}}"}) {
    const BoardConfig board = fpl2003({std::string("ssram.banks=") + banks,
                                       "allocation={left_image: a, right_image: a, disparity: [a, b], "
                                       "left_lut: c, right_lut: none}"});
    ASSERT_EQ(platform::buffers(board.allocation).size(), 5U);
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
  const BoardConfig board = placed(fpl2003(), {0, 1, 2, 2, 3, 4, 5, 0});
  EXPECT_THAT(board.allocation.left_image, ElementsAre("bank0", "bank1"));
  EXPECT_THAT(board.allocation.right_image, ElementsAre("bank2", "bank2"));
  EXPECT_THAT(board.allocation.disparity, ElementsAre("bank3", "bank4"));
  EXPECT_EQ(board.allocation.left_lut, "bank5");
  EXPECT_EQ(board.allocation.right_lut, "bank0");
  const BoardConfig without = placed(fpl2003({"allocation.left_lut=none"}), {0, 1, 2, 2, 3, 4, 0});
  EXPECT_EQ(without.allocation.left_lut, std::nullopt);
  EXPECT_EQ(without.allocation.right_lut, "bank0");
}

TEST(BoardOfFrame, HasTheBuffersOfThatFrameInTheFirstBanksThatAreAlike) {
  const Placement placement = {6, 7, 6, 5, 4, 4, 3, 7};
  const BoardConfig first = board_of_frame(fpl2003(), placement, 0);
  EXPECT_THAT(first.allocation.left_image, ElementsAre("bank0"));
  EXPECT_THAT(first.allocation.right_image, ElementsAre("bank0"));
  EXPECT_THAT(first.allocation.disparity, ElementsAre("bank1"));
  EXPECT_EQ(first.allocation.left_lut, "bank2");
  EXPECT_EQ(first.allocation.right_lut, "bank3");
  const BoardConfig second = board_of_frame(fpl2003(), placement, 1);
  EXPECT_EQ(second.allocation.left_image, second.allocation.right_lut.has_value()
                                              ? std::vector<std::string>{*second.allocation.right_lut}
                                              : std::vector<std::string>{});
  const BoardConfig other = fpl2003({"ssram.banks.bank0.kind=zbt_flow_through"});
  EXPECT_THAT(board_of_frame(other, placement, 0).allocation.left_image, ElementsAre("bank1"));
}

TEST(Frames, AreIndependentWithFixedPriorityAndWithoutTurnaround) {
  EXPECT_TRUE(frames_are_independent(fpl2003()));
  EXPECT_FALSE(frames_are_independent(fpl2003({"fpga.arbitration=round_robin"})));
  EXPECT_FALSE(
      frames_are_independent(fpl2003({"ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 1}"})));
}

// Where bounds rule nothing out.
double no_bound(const BoardConfig& /*board*/) { return 1e9; }

AllocationSearch core_search(const BoardConfig& board, int most_banks) {
  return AllocationSearch(board, most_banks, {}, no_bound);
}

TEST(AllocationSearch, NeedsARunForEachWayInWhichAFramesBuffersShare) {
  const AllocationSearch search = core_search(fpl2003(), 8);
  EXPECT_TRUE(search.by_frames());
  EXPECT_EQ(search.placements(), 4140U);
  EXPECT_EQ(search.fitting(), 2507U);
  EXPECT_EQ(search.size(), 35U);
  EXPECT_EQ(search.next().size(), 35U);
  EXPECT_EQ(search.most_left(), 35U);
  EXPECT_EQ(search.point(0).run.frames, 1U);
  // With banks that hold everything each of the 52 ways occurs.
  EXPECT_EQ(core_search(fpl2003({"ssram.default.words=2097152"}), 8).size(), 52U);
}

TEST(AllocationSearch, RunsEachPlacementWhereFramesAreNotIndependent) {
  const AllocationSearch core = core_search(fpl2003({"fpga.arbitration=round_robin"}), 3);
  EXPECT_EQ(core.size(), core.fitting());
  EXPECT_EQ(core.point(0).run.frames, 2U);
  const AllocationSearch computer(fpl2003(), 3, {true, 0, ""}, no_bound);
  EXPECT_EQ(computer.size(), computer.fitting());
  EXPECT_EQ(computer.point(0).run.frames, kCameraFrames);
}

// With made-up cycles: the more buffers share, the longer a frame.
TEST(AllocationSearch, FindsTheBestForEachNumberOfBanks) {
  AllocationSearch search = core_search(fpl2003(), 8);
  for (const std::size_t number : search.next()) {
    std::set<std::string> banks;
    for (const auto& buffer : platform::buffers(search.point(number).board->allocation))
      banks.insert(buffer.bank);
    AllocationOutcome outcome;
    outcome.cycles = 1000 * (6 - banks.size());
    search.record(number, outcome);
  }
  EXPECT_TRUE(search.next().empty());
  EXPECT_EQ(search.most_left(), 0U);
  const auto all = search.best();
  ASSERT_EQ(all.size(), 6U);
  std::uint64_t placements = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].banks, static_cast<int>(i) + 3);
    EXPECT_EQ(banks_used(all[i].witness), all[i].banks);
    EXPECT_EQ(all[i].frames_per_second, 40e6 * 2 / static_cast<double>(all[i].outcome.cycles));
    EXPECT_EQ(all[i].known, all[i].placements);
    placements += all[i].placements;
  }
  EXPECT_EQ(placements, search.fitting());
  EXPECT_EQ(all.back().reached_by, 1U);
  EXPECT_EQ(all.back().outcome.cycles, 2000U);
  EXPECT_EQ(all[2].outcome.cycles, 2000U) << "five banks are enough for the five buffers of each frame";
  EXPECT_EQ(all[0].outcome.cycles, 6000U);
}

TEST(AllocationSearch, FailsEachPlacementOfWhichAFrameFails) {
  const BoardConfig board = fpl2003();
  AllocationSearch search = core_search(board, 8);
  const std::string failing = allocation_text(*search.point(1).board);
  for (const std::size_t number : search.next()) {
    AllocationOutcome outcome;
    outcome.cycles = 1000;
    if (number == 1) outcome = {0, 0, {}, false, "no slot consumed"};
    search.record(number, outcome);
  }
  std::map<int, std::uint64_t> expected;  // by banks
  for (const Placement& placement : placements_of(board, 8)) {
    if (!fits(board, placement)) continue;
    const bool fails = allocation_text(board_of_frame(board, placement, 0)) == failing ||
                       allocation_text(board_of_frame(board, placement, 1)) == failing;
    expected[banks_used(placement)] += std::uint64_t{fails};
  }
  std::uint64_t failed = 0;
  for (const BestPlacement& best : search.best()) {
    EXPECT_EQ(best.failed, expected[best.banks]) << best.banks;
    EXPECT_EQ(best.reached_by, best.placements - best.failed) << "all others need the same cycles";
    failed += best.failed;
  }
  EXPECT_GT(failed, 0U);
  EXPECT_EQ(search.first_failure(), failing + ": no slot consumed");
}

TEST(AllocationSearch, TakesNoRateOfAPlacementThatLosesPixelsOrFails) {
  const BoardConfig board = fpl2003();
  AllocationSearch search(board, 3, {true, 0, ""}, no_bound);
  const std::vector<std::size_t> numbers = search.next();  // as many banks each
  ASSERT_GT(numbers.size(), 3U);
  search.record(numbers[0], {1000, 50, 50, true, ""});
  search.record(numbers[1], {1000, 40, 40, false, "no slot consumed"});
  EXPECT_EQ(search.rate_to_reach(numbers[3]), 0);
  ASSERT_EQ(search.best().size(), 1U);
  EXPECT_EQ(search.best()[0].reached_by, 0U);
  search.record(numbers[2], {1000, 20, 20, false, ""});
  EXPECT_NEAR(search.rate_to_reach(numbers[3]), 20, 1e-6);
  const BestPlacement best = search.best()[0];
  EXPECT_EQ(best.known, 3U);
  EXPECT_EQ(best.losing, 1U);
  EXPECT_EQ(best.failed, 1U);
  EXPECT_EQ(best.reached_by, 1U);
  EXPECT_EQ(best.frames_per_second, 20);
  EXPECT_EQ(placed(board, best.witness).allocation.left_image,
            search.point(numbers[2]).board->allocation.left_image);
}

// Made-up rates of a computer, from 10 to 20 frames/s, and bounds by up to a tenth above them.
class ComputerSearch : public ::testing::Test {
 protected:
  static std::uint64_t mixed(const BoardConfig& board) {
    std::uint64_t mix = 1469598103934665603U;
    for (const auto& buffer : platform::buffers(board.allocation)) {
      for (const char c : buffer.bank) mix = (mix ^ static_cast<unsigned char>(c)) * 1099511628211U;
      mix ^= mix >> 29U;
    }
    return mix;
  }
  static double rate_of(const BoardConfig& board) {
    return 10 + static_cast<double>(mixed(board) % 101) / 10;
  }
  static double bound_of(const BoardConfig& board) {
    return rate_of(board) * (1 + static_cast<double>(mixed(board) / 101 % 100) / 1000);
  }
  static bool loses(const BoardConfig& board) { return mixed(board) / 10100 % 10 == 0; }

  AllocationSearch search{fpl2003(), 8, {true, 0, ""}, bound_of};
};

TEST_F(ComputerSearch, FindsTheBestThatLosesNoPixelsAndLeavesOutWhatABoundRulesOut) {
  std::map<int, std::pair<double, std::uint64_t>> expected;  // best rate, reached by
  std::map<int, std::uint64_t> placements;
  for (std::size_t number = 0; number < search.size(); ++number) {
    const BoardConfig board = *search.point(number).board;
    std::set<std::string> banks;
    for (const auto& buffer : platform::buffers(board.allocation)) banks.insert(buffer.bank);
    ++placements[static_cast<int>(banks.size())];
    if (loses(board)) continue;
    auto& [rate, reached_by] = expected[static_cast<int>(banks.size())];
    if (rate_of(board) > rate) reached_by = 0;
    rate = std::max(rate, rate_of(board));
    if (rate_of(board) == rate) ++reached_by;
  }
  std::uint64_t simulated = 0;
  std::uint64_t given_up = 0;
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    for (const std::size_t number : numbers) {
      const BoardConfig board = *search.point(number).board;
      ++simulated;
      if (!loses(board) && rate_of(board) < search.rate_to_reach(number) && number % 2 == 0) {
        search.record_given_up(number);
        ++given_up;
      } else {
        search.record(number, {1000, rate_of(board), rate_of(board) + 1, loses(board), ""});
      }
    }
    EXPECT_LE(simulated + search.most_left(), search.size());
  }
  EXPECT_LT(simulated, search.size() / 2);
  EXPECT_GT(given_up, 0U);
  std::uint64_t known = 0;
  for (const BestPlacement& best : search.best()) {
    ASSERT_EQ(expected.count(best.banks), std::size_t{best.reached_by > 0}) << best.banks;
    EXPECT_EQ(best.placements, placements[best.banks]);
    known += best.known + best.given_up;
    if (best.reached_by == 0) continue;
    EXPECT_EQ(best.frames_per_second, expected[best.banks].first) << best.banks;
    EXPECT_EQ(best.reached_by, expected[best.banks].second) << best.banks;
    EXPECT_EQ(rate_of(placed(fpl2003(), best.witness)), best.frames_per_second);
    EXPECT_EQ(best.outcome.steady, best.frames_per_second + 1);
  }
  EXPECT_EQ(known, simulated);
}

TEST_F(ComputerSearch, RefusesARateAboveItsBound) {
  const std::size_t number = search.next().front();
  EXPECT_THROW(search.record(number, {1000, 100, 100, false, ""}), std::logic_error);
  search.record(number, {1000, 100, 100, true, ""});  // moves fewer words than the bound counts
}

TEST(AllocationPoints, AreThoseOfTheirNumbers) {
  const AllocationSearch search = core_search(fpl2003(), 8);
  const AllocationPoints points(search, {7, 3});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.point(0).hash, search.point(7).hash);
  EXPECT_EQ(points.point(1).number, 3U);
}

}  // namespace
}  // namespace stereotlm::explore
