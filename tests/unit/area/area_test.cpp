#include "models/area/area.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/scratch_folder.h"
#include "tests/unit/area/cores.h"

namespace stereotlm::area {
namespace {

using kernels::FilterKernel;

TEST(AreaItems, AreRefusedForACoreWithProblems) {
  EXPECT_EQ(test::message_of([] { items(core(kWindow, 8)); }), "window = 8: must be 3..31, odd");
}

// Bits of the sum of n pixel differences, and of n columns of them.
struct SumBits {
  int window;
  int column;
  int window_sum;
};
constexpr SumBits kSumBits[] = {
    {3, 10, 12},  {5, 11, 13},  {7, 11, 14},  {9, 12, 15},
    {11, 12, 15}, {15, 12, 16}, {17, 13, 17}, {31, 13, 18},
};

TEST(ColumnModules, TakeAnAbsoluteDifferenceAndAnAccumulator) {
  for (const SumBits& bits : kSumBits)
    expect_all("column modules",
               {{core(kWindow, bits.window), 80 * (Resources{32 + bits.column, 8 + 2 * bits.column})}});
}

TEST(ColumnModules, AddUpAWholeColumnBehindALineBuffer) {
  // 3 = 1 + 2 differences in adders of 9 and 10 bits; 7 = (1 + 2) + (2 + 2).
  expect_all("column modules",
             {{core(kFetch, Fetch::kLineBuffer, kWindow, 3), 80 * Resources{3 * 32 + 9 + 10, 3 * 8 + 2 * 10}},
              {core(kFetch, Fetch::kLineBuffer),
               80 * Resources{7 * 32 + (9 + 10) + (9 + 9 + 10) + 11, 7 * 8 + 2 * 11}}});
}

TEST(WindowModules, TakeAShiftRegisterADifferenceAndAnAccumulator) {
  for (const SumBits& bits : kSumBits) {
    const int srls = bits.window <= 16 ? 1 : 2;
    const Resources one{srls * bits.column + (bits.column - 1) + 2 * bits.window_sum, 2 * bits.window_sum};
    expect_all("window modules", {{core(kWindow, bits.window), 80 * one},
                                  {core(kWindow, bits.window, kFetch, Fetch::kLineBuffer), 80 * one}});
  }
}

TEST(RightPixelDelays, AreOneColumnEach) {
  expect_all("right pixel delays", {{core(kWindow, 15), {79 * 8}},
                                    {core(kWindow, 17), {79 * 16}},
                                    {core(kFetch, Fetch::kLineBuffer), {0, 79 * 7 * 8}},
                                    {core(kDisparities, 1), {}}});
}

TEST(ModuleArea, IsProportionalToTheDisparities) {
  for (const char* const name : {"column modules", "window modules", "candidate marks"}) {
    const Resources one = all_of(core(kDisparities, 1), name);
    for (const int disparities : {2, 80, 160, 254})
      expect_all(name, {{core(kDisparities, disparities), disparities * one}});
  }
  expect_all("candidate marks", {{core(kDisparities, 1), {2, 1}}});
}

// Windows of 7x7 have sums of 14 bits. Each comparison takes a comparator, the decision and a selector.
constexpr int kComparison = 15 + 1 + 14;

TEST(SelectMinUnitA, IsAChainWhoseDisparitiesWiden) {
  expect_all("select-min unit A", {{core(kDisparities, 1), {0, 15}},
                                   {core(kDisparities, 2), {kComparison + 1, 15 + 16}},
                                   {core(kTolerance, std::nullopt), {}}});
  // Module 127 passes on 7 bits, module 128 one bit more.
  const auto last_of = [](int disparities) {
    const Resources chain = all_of(core(kDisparities, disparities), "select-min unit A");
    const Resources before = all_of(core(kDisparities, disparities - 1), "select-min unit A");
    return Resources{chain.luts - before.luts, chain.flip_flops - before.flip_flops};
  };
  EXPECT_EQ(last_of(128), (Resources{kComparison + 7, 15 + 7}));
  EXPECT_EQ(last_of(129), (Resources{kComparison + 8, 15 + 8}));
}

TEST(SelectMinUnitB, IsATreeOfOneComparatorLessThanDisparities) {
  // 8 disparities: 4 comparisons, then 2, then 1. 5 disparities: 2 comparisons, then 1, then 1; in the first
  // two stages one disparity waits.
  expect_all("select-min unit B",
             {{core(kDisparities, 1), {}},
              {core(kDisparities, 2), {kComparison, 16}},
              {core(kDisparities, 8), {7 * kComparison + 2 * 1 + 1 * 2, 4 * 16 + 2 * 17 + 1 * 18}},
              {core(kDisparities, 5), {4 * kComparison + 1 + 2, (2 * 16 + 15) + (17 + 16) + 18}}});
  EXPECT_EQ(item_of(core(kDisparities, 5), "select-min unit B").count, 4);
}

TEST(LeftRightCheck, KeepsDisparitiesInMemoriesOfLuts) {
  // Two memories of 8 bits with the adders of their addresses; a difference of 8 bits, two selectors and a
  // valid bit. 16 places take 2 LUTs a bit, 32 take 4. Memories of 64 are joined by a multiplexer.
  constexpr int kCheck = 4 * 8 + 2 * 8 + 1;
  expect_all("left-right check", {{core(kDisparities, 16), {2 * (2 * 8 + 4) + kCheck}},
                                  {core(kDisparities, 17), {2 * (4 * 8 + 5) + kCheck}},
                                  {core(kDisparities, 128), {2 * (2 * 8 * 8 + 8 + 7) + kCheck}},
                                  {core(kTolerance, 253), all_of(core(), "left-right check")},
                                  {core(kTolerance, std::nullopt), {2 * 8 * 8 + 8 + 7 + 8 + 1}}});
}

TEST(LeftRightCheck, DelaysTheValidBitOfItsOwnPixel) {
  const auto luts = [](const CoreConfig& config) { return all_of(config, "left-right check").luts; };
  EXPECT_EQ(luts(core(kRightTable, false)), luts(core()));
  EXPECT_EQ(luts(core(kLeftTable, false)), luts(core()) - 1);
  // Half a window and half the filter: 13 + 3 columns, then one more.
  EXPECT_EQ(luts(core(kWindow, 29)), luts(core(kWindow, 27)) + 1);
}

TEST(LaneArea, HasQueuesOfTableEntriesAndOfPixels) {
  for (const auto& [slots, luts] : {std::pair{2, 2}, {16, 2}, {17, 4}, {64, 8}}) {
    expect_all("table entry queues", {{core(kLaneSlots, slots), {2 * (23 * (luts + 1) + 28), 2 * 17}}});
    expect_all("pixel queues", {{core(kLaneSlots, slots), {(9 + 8) * (luts + 1) + 2 * 28, 2 * 17}}});
  }
  expect_all("table entry queues", {{core(kLaneSlots, 1), {2 * (23 + 28), 2 * (23 + 17)}}});
}

TEST(LaneArea, HasTableEntriesOnlyForTables) {
  const CoreConfig one_table = core(kRightTable, false);
  const CoreConfig no_table = core(kRightTable, false, kLeftTable, false);
  expect_all("table entry queues", {{one_table, {3 * 23 + 28, 17}}, {no_table, {}}});
  expect_all("source addresses", {{one_table, {19 + 26, 0, 0, 1}}, {no_table, {}}});
  expect_all("pixel queues", {{one_table, {3 * 17 + 56, 34}}, {no_table, {3 * 16 + 56, 34}}});
  expect_all("byte selectors", {{no_table, {2 * 16}}});
}

TEST(LaneArea, MultipliesRowsByAWidthThatIsNoPowerOfTwo) {
  // 640 x 480 - 1 takes 19 bits, 640 x 820 - 1 takes 20.
  expect_all("source addresses", {{core(), {2 * (19 + 26), 0, 0, 2}},
                                  {core(kHeight, 820), {2 * (20 + 26), 0, 0, 2}},
                                  {core(kWidth, 516), {2 * (18 + 26), 0, 0, 2}},
                                  {core(kWidth, 4), {2 * 26}},
                                  {core(kWidth, 512), {2 * 26}},
                                  {core(kWidth, 2048), {2 * 26}}});
}

TEST(ResultArea, HoldsAPartOfAWordAndAQueueOfWords) {
  expect_all("result packer", {{core(), {0, 24}}});
  expect_all("result queue",
             {{core(kResultWords, 1), {92, 64 + 32}}, {core(kResultWords, 2), {92, 64, 1, 0}}});
}

TEST(FilterArea, TakesOneFilterPerSide) {
  expect_all("filters", {{core(), {2 * 505, 2 * 306, 0, 2 * 10}}});
  for (const char* const name : {"filters", "filter columns", "filter line memories"})
    EXPECT_EQ(item_of(core(kFilter, std::nullopt), name).count, 0) << name;
}

TEST(FilterArea, KeepsEarlierColumnsInShiftRegisters) {
  // 6 columns of 7 pixels, on the left with valid bits.
  expect_all("filter columns",
             {{core(), {6 * (9 + 8)}}, {core(kFetch, Fetch::kLineBuffer), {0, 6 * (9 + 8)}}});
}

TEST(FilterArea, HasLineMemoriesOfTheWidthOfTheImage) {
  // 105 bits, and the last row with 9.
  for (const auto& [width, count] : {std::pair{512, 3 + 1},
                                     {516, 6 + 1},
                                     {1024, 6 + 1},
                                     {1028, 12 + 1},
                                     {2048, 12 + 1},
                                     {2052, 27 + 3},
                                     {8192, 53 + 5}}) {
    const bool has_tables = width <= 2048;
    expect_all("filter line memories", {{core(kWidth, width, kLeftTable, has_tables, kRightTable, has_tables),
                                         block_rams(2 * count)}});
  }
}

TEST(RowBufferArea, BelongsToTheLineBufferOnly) {
  EXPECT_EQ(item_of(core(), "row buffers").count, 0);
  // 6 rows of 8 bits: 48, and on the left 3 valid bits.
  for (const auto& [width, count] : {std::pair{512, 2}, {516, 3}, {1024, 3}, {1028, 6}})
    expect_all("row buffers", {{core(kFetch, Fetch::kLineBuffer, kFilter, std::nullopt, kWidth, width),
                                block_rams(2 * count)}});
}

TEST(RowBufferArea, HoldsTheValidBitsOfTheLeftTable) {
  // 2 rows of 8 bits and 1 valid bit: two memories of 9 bits. With the filter 4 valid bits.
  const CoreConfig filtered = core(kFetch, Fetch::kLineBuffer, kWidth, 2048, kWindow, 3);
  CoreConfig plain = filtered;
  plain.filter.reset();
  CoreConfig without_table = filtered;
  without_table.left_table = false;
  expect_all("row buffers",
             {{plain, block_rams(2 + 2)}, {filtered, block_rams(3 + 2)}, {without_table, block_rams(2 + 2)}});
}

TEST(ControlArea, HasAPortForEachTableAndLaneTheResultsAndTheHost) {
  const auto ports = [](const CoreConfig& config) { return item_of(config, "bank multiplexers").count; };
  EXPECT_EQ(ports(core()), 6);
  EXPECT_EQ(ports(core(kRightTable, false)), 5);
  EXPECT_EQ(ports(core(kJoint, true)), 5);
  EXPECT_EQ(ports(core(kLanes, 4)), 4 * 4 + 2);
  expect_all("bank multiplexers", {{core(), 6 * Resources{150, 13}}});
  EXPECT_EQ(item_of(core(), "slot positions").count, 1);
  EXPECT_EQ(item_of(core(kFilter, std::nullopt), "slot positions").count, 0);
}

}  // namespace
}  // namespace stereotlm::area
