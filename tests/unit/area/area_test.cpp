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
               {{core(kWindow, bits.window), 80 * (Resources{17 + bits.column, bits.column})}});
}

TEST(ColumnModules, AddUpAWholeColumnBehindALineBuffer) {
  // 3 = 1 + 2 differences in adders of 9 and 10 bits; 7 = (1 + 2) + (2 + 2).
  expect_all("column modules",
             {{core(kFetch, Fetch::kLineBuffer, kWindow, 3), 80 * Resources{3 * 17 + 9 + 10, 10}},
              {core(kFetch, Fetch::kLineBuffer), 80 * Resources{7 * 17 + (9 + 10) + (9 + 9 + 10) + 11, 11}}});
}

TEST(WindowModules, TakeAShiftRegisterADifferenceAndAnAccumulator) {
  for (const SumBits& bits : kSumBits) {
    const int srls = bits.window <= 16 ? 1 : 2;
    const Resources one{srls * bits.column + (bits.column + 1) + bits.window_sum, bits.window_sum};
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
  expect_all("candidate marks", {{core(kDisparities, 1), {0, 1}}});
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

TEST(LeftRightCheck, DelaysTheLeftBasedDisparities) {
  // 17 disparities: 5 bits and a valid bit wait 16 columns; then a difference of 5 bits, the tolerance, the
  // decision. The tolerance of 4 bits takes one LUT. Without a check only the delays remain.
  constexpr int kCheck = 1 + (6 + 5) + 2 + 1 + 8;
  expect_all("left-right check", {{core(kDisparities, 17), {6 + kCheck, 0, 1, 0}},
                                  {core(kDisparities, 18), {2 * 6 + kCheck, 0, 1, 0}},
                                  {core(kDisparities, 16), {5 + 1 + (5 + 4) + 1 + 1 + 8, 0, 1, 0}},
                                  {core(kTolerance, 253), all_of(core(), "left-right check")},
                                  {core(kTolerance, std::nullopt), {5 * 8 + 1 + 8}}});
}

TEST(LeftRightCheck, DelaysTheValidBitOfItsOwnPixel) {
  const auto luts = [](const CoreConfig& config) { return all_of(config, "left-right check").luts; };
  EXPECT_EQ(luts(core(kRightTable, false)), luts(core()));
  EXPECT_EQ(luts(core(kLeftTable, false)), luts(core()) - 1);
  // Half a window and half the filter: 13 + 3 columns, then one more.
  EXPECT_EQ(luts(core(kWindow, 29)), luts(core(kWindow, 27)) + 1);
}

TEST(LaneArea, HasQueuesOfTableEntriesAndOfPixels) {
  for (const auto& [slots, luts] : {std::pair{2, 1}, {16, 1}, {17, 2}, {64, 4}}) {
    expect_all("table entry queues", {{core(kLaneSlots, slots), {2 * 23 * luts}}});
    expect_all("pixel queues", {{core(kLaneSlots, slots), {(9 + 8) * luts}}});
  }
  expect_all("table entry queues", {{core(kLaneSlots, 1), {0, 2 * 23}}});
  expect_all("pixel queues", {{core(kLaneSlots, 1), {0, 9 + 8}}});
}

TEST(LaneArea, HasTableEntriesOnlyForTables) {
  const CoreConfig one_table = core(kRightTable, false);
  const CoreConfig no_table = core(kRightTable, false, kLeftTable, false);
  expect_all("table entry queues", {{one_table, {23}}, {no_table, {}}});
  expect_all("source addresses", {{one_table, {19, 0, 0, 1}}, {no_table, {}}});
  expect_all("pixel queues", {{one_table, {9 + 8}}, {no_table, {8 + 8}}});
  expect_all("byte selectors", {{no_table, {2 * 16}}});
}

TEST(LaneArea, MultipliesRowsByAWidthThatIsNoPowerOfTwo) {
  // 640 x 480 - 1 takes 19 bits, 640 x 820 - 1 takes 20.
  expect_all("source addresses", {{core(), {2 * 19, 0, 0, 2}},
                                  {core(kHeight, 820), {2 * 20, 0, 0, 2}},
                                  {core(kWidth, 516), {2 * 18, 0, 0, 2}},
                                  {core(kWidth, 4), {}},
                                  {core(kWidth, 512), {}},
                                  {core(kWidth, 2048), {}}});
}

TEST(ResultArea, HoldsAPartOfAWordAndAQueueOfWords) {
  expect_all("result packer", {{core(), {0, 24}}});
  expect_all("result queue", {{core(kResultWords, 1), {0, 32}},
                              {core(kResultWords, 2), {32}},
                              {core(kResultWords, 16), {32}},
                              {core(kResultWords, 17), {64}}});
}

TEST(FilterArea, TakesOneFilterPerSide) {
  expect_all("filters", {{core(), {2 * 259, 2 * 94, 0, 2 * 10}}});
  for (const char* const name : {"filters", "filter columns", "filter line memories"})
    EXPECT_EQ(item_of(core(kFilter, std::nullopt), name).count, 0) << name;
}

TEST(FilterArea, KeepsEarlierColumnsInBlockRamOrRegisters) {
  // 6 columns of 7 pixels: 48 bits in memories of 36.
  expect_all("filter columns",
             {{core(), block_rams(2 * 2)}, {core(kFetch, Fetch::kLineBuffer), {0, 2 * 48}}});
}

TEST(FilterArea, HasLineMemoriesOfTheWidthOfTheImage) {
  // 94 bits.
  for (const auto& [width, count] :
       {std::pair{512, 3}, {516, 6}, {1024, 6}, {1028, 11}, {2048, 11}, {2052, 24}, {8192, 47}}) {
    const bool has_tables = width <= 2048;
    expect_all("filter line memories", {{core(kWidth, width, kLeftTable, has_tables, kRightTable, has_tables),
                                         block_rams(2 * count)}});
  }
}

TEST(FilterArea, KeepsValidBitsOfRowsThatTheColumnNoLongerHas) {
  // 30 sums of 8 bits are 240 bits. With windows of 7 the middle of the left window is 12 rows above the
  // newest 7 rows. In the second kernel the last sum may have either sign: 241 bits.
  FilterKernel kernel{31, std::vector<int>(961, 0), 0};
  kernel.weights[0] = 1;
  kernel.weights[960] = -1;
  FilterKernel wider = kernel;
  std::swap(wider.weights[960], wider.weights[929]);
  expect_all("filter line memories",
             {{core(kWidth, 512, kFilter, kernel), block_rams(7 + 7)},
              {core(kWidth, 512, kFilter, wider), block_rams(8 + 7)},
              {core(kWidth, 512, kFilter, wider, kLeftTable, false), block_rams(7 + 7)},
              {core(kWidth, 512, kFilter, wider, kWindow, 31), block_rams(7 + 7)}});
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

}  // namespace
}  // namespace stereotlm::area
