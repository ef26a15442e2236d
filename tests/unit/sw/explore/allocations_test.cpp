#include "sw/explore/allocations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "platform/board_rules.h"
#include "platform/board_yaml.h"
#include "sw/explore/allocation_search.h"

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
  const BoardConfig board =
      fpl2003({"ssram.banks={a: {}, b: {words: 1048576}, c: {}, d: {kind: zbt_flow_through}}",
               "allocation={left_image: a, right_image: a, disparity: [a, b], left_lut: c, "
               "right_lut: none}"});
  const std::size_t buffers = platform::buffers(board.allocation).size();
  ASSERT_EQ(buffers, 5U);
  for (int most_banks = 1; most_banks <= 4; ++most_banks) {
    std::set<Placement> expected;
    for (int code = 0; code < 1024; ++code) {
      Placement placement;
      for (int i = 0; i < 5; ++i) placement.push_back(code >> (2 * i) & 3);
      if (banks_used(placement) > most_banks) continue;
      Placement exchanged = placement;  // a and c, which are alike
      for (int& bank : exchanged) bank = bank == 0 ? 2 : bank == 2 ? 0 : bank;
      expected.insert(std::min(placement, exchanged));
    }
    const auto found = placements_of(board, most_banks);
    EXPECT_EQ(std::set<Placement>(found.begin(), found.end()), expected) << most_banks;
    EXPECT_EQ(found.size(), expected.size()) << "each once";
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

TEST(AllocationSearch, NeedsARunForEachWayInWhichAFramesBuffersShare) {
  const AllocationSearch search(fpl2003(), 8);
  EXPECT_EQ(search.placements(), 4140U);
  EXPECT_EQ(search.fitting(), 2507U);
  EXPECT_EQ(search.size(), 35U);
  EXPECT_EQ(search.point(0).run.frames, 1U);
  // With banks that hold everything each of the 52 ways occurs.
  EXPECT_EQ(AllocationSearch(fpl2003({"ssram.default.words=2097152"}), 8).size(), 52U);
}

TEST(AllocationSearch, RunsEachPlacementWhereFramesAreNotIndependent) {
  const BoardConfig board = fpl2003({"fpga.arbitration=round_robin"});
  const AllocationSearch search(board, 3);
  EXPECT_EQ(search.size(), search.fitting());
  EXPECT_EQ(search.point(0).run.frames, 2U);
}

// With made-up cycles: the more buffers share, the longer a frame.
TEST(AllocationSearch, FindsTheBestForEachNumberOfBanks) {
  const BoardConfig board = fpl2003();
  const AllocationSearch search(board, 8);
  std::vector<std::uint64_t> cycles;
  for (std::uint64_t number = 0; number < search.size(); ++number) {
    std::set<std::string> banks;
    for (const auto& buffer : platform::buffers(search.point(number).board->allocation))
      banks.insert(buffer.bank);
    cycles.push_back(1000 * (6 - banks.size()));
  }
  const auto all = search.best(cycles);
  ASSERT_EQ(all.size(), 6U);
  std::uint64_t placements = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].banks, static_cast<int>(i) + 3);
    EXPECT_EQ(banks_used(all[i].witness), all[i].banks);
    EXPECT_EQ(search.cycles_of(all[i].witness, cycles), all[i].cycles);
    EXPECT_EQ(all[i].frames_per_second, 40e6 * 2 / static_cast<double>(all[i].cycles));
    placements += all[i].placements;
  }
  EXPECT_EQ(placements, search.fitting());
  EXPECT_EQ(all.back().reached_by, 1U);
  EXPECT_EQ(all.back().cycles, 2000U);
  EXPECT_EQ(all[2].cycles, 2000U) << "five banks are enough for the five buffers of each frame";
  EXPECT_EQ(all[0].cycles, 6000U);
}

}  // namespace
}  // namespace stereotlm::explore
