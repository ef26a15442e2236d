#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "models/area/area.h"
#include "tests/unit/area/cores.h"

namespace stereotlm::area {
namespace {

using kernels::CostKind;
using kernels::MatchingCost;

constexpr MatchingCost kSsd{CostKind::kSsd, 0};
constexpr MatchingCost kZncc{CostKind::kZncc, 0};
constexpr MatchingCost census(int size) { return {CostKind::kCensus, size}; }
constexpr auto kWord = fpga::PixelCache::kWord;

void expect_same(const CoreConfig& one, const CoreConfig& other) {
  const std::vector<Item> items_of_one = items(one);
  const std::vector<Item> items_of_other = items(other);
  ASSERT_EQ(items_of_one.size(), items_of_other.size());
  for (std::size_t i = 0; i < items_of_one.size(); ++i) {
    EXPECT_EQ(items_of_one[i].name, items_of_other[i].name);
    EXPECT_EQ(items_of_one[i].count, items_of_other[i].count) << items_of_one[i].name;
    EXPECT_EQ(items_of_one[i].all, items_of_other[i].all) << items_of_one[i].name;
  }
}

TEST(FoldedArea, IsTheWholeAreaIfThereIsAModuleForEachDisparity) { expect_same(core(), core(kUnits, 80)); }

// Windows of 7x7: sums of columns have 11 bits, sums of windows 14.
TEST(FoldedArea, KeepsAPlaceForEachPassInShiftRegisters) {
  expect_all("column modules", {{core(kUnits, 40), 40 * Resources{32 + 11 + 11, 8 + 11}},
                                {core(kUnits, 27), 27 * Resources{32 + 11 + 11, 8 + 11}},
                                {core(kUnits, 5), 5 * Resources{32 + 11 + 11, 8 + 11}},  // 16 passes
                                {core(kUnits, 4), 4 * Resources{32 + 11 + 2 * 11, 8 + 11}}});
  expect_all("window modules", {{core(kUnits, 40), 40 * Resources{11 + 10 + 3 * 14, 14}},  // 14 places
                                {core(kUnits, 27), 27 * Resources{2 * 11 + 10 + 3 * 14, 14}}});
  expect_all("candidate marks", {{core(kUnits, 40), {3 * 40}}, {core(kUnits, 4), {4 * 4}}});
  const CoreConfig line_buffer = core(kFetch, Fetch::kLineBuffer, kUnits, 40);
  const Resources all = all_of(core(kFetch, Fetch::kLineBuffer), "column modules");
  expect_all("column modules", {{line_buffer, {all.luts / 2, all.flip_flops / 2}}});
}

TEST(FoldedArea, LeadsRightPixelsBackToTheFirstModule) {
  expect_all("right pixel delays", {{core(kUnits, 40), {39 * 8 + 8 + 8}},
                                    {core(kUnits, 27), {26 * 16 + 16 + 8}},
                                    {core(kUnits, 1), {(7 * 80 + 1 + 15) / 16 * 8 + 8}},
                                    {core(kFetch, Fetch::kLineBuffer, kUnits, 40), {39 * 56 + 56 + 56}}});
  EXPECT_EQ(item_of(core(kUnits, 40), "right pixel delays").count, 40);
}

// A comparison takes a comparator of 14 bits, the decision and a selector. Of 80 disparities on 40 modules
// the pass has 1 bit and the module 6. 40 * pass + module takes a multiplier and an adder of 7 bits.
TEST(FoldedArea, ContinuesTheChainInTheNextPass) {
  constexpr int kComparison = 15 + 1 + 14 + 7;
  expect_all("select-min unit A", {{core(kUnits, 40), {40 * (kComparison + 22) + 7, 22, 0, 1}},
                                   {core(kUnits, 64), {64 * (kComparison + 22), 22}}});  // a power of two
  EXPECT_EQ(item_of(core(kUnits, 40), "select-min unit A").count, 40);
}

TEST(FoldedArea, KeepsTheSmallestSumOfThePassesSoFar) {
  const Resources tree = all_of(core(kDisparities, 40), "select-min unit B");
  expect_all("select-min unit B", {{core(kUnits, 40), tree + Resources{15 + 1 + 14 + 7 + 7, 22, 0, 1}},
                                   {core(kUnits, 1), {15 + 1 + 14 + 7, 22}}});
  EXPECT_EQ(item_of(core(kUnits, 40), "select-min unit B").count, 40);
}

// 4 rows of results: columns of 10 slots.
TEST(RowsArea, SharesPixelsFiltersAndColumnModules) {
  for (const char* const name : {"pixel queues", "filters", "filter columns", "filter line memories",
                                 "right pixel delays", "candidate marks", "result queue"})
    expect_all(name, {{core(kRows, 4), all_of(core(), name)}});
  expect_all("right pixel delays",
             {{core(kRows, 10, kResultWords, 10), {79 * 8}}, {core(kRows, 11, kResultWords, 11), {79 * 16}}});
  // A column sum that slides over 7 pixel differences: they are kept, and the old one is subtracted.
  expect_all("column modules",
             {{core(kRows, 4), 80 * Resources{32 + 11 + 8 + 9, 8 + 2 * 11}},
              {core(kRows, 4, kUnits, 27), 27 * Resources{32 + 11 + 11 + 2 * 8 + 9, 8 + 11}}});
}

TEST(RowsArea, HasWindowsSelectUnitsAndChecksForEachRow) {
  for (const char* const name :
       {"window modules", "select-min unit A", "select-min unit B", "left-right check"}) {
    expect_all(name, {{core(kRows, 4), 4 * all_of(core(), name)},
                      {core(kRows, 4, kUnits, 40), 4 * all_of(core(kUnits, 40), name)}});
    EXPECT_EQ(item_of(core(kRows, 4), name).count, 4 * item_of(core(), name).count);
  }
}

TEST(RowsArea, KeepsCompleteWordsUntilTheQueueTakesThem) {
  expect_all("result packer", {{core(kRows, 2), {32, 2 * 32}}, {core(kRows, 4), {2 * 32, 4 * 32}}});
  EXPECT_EQ(item_of(core(kRows, 4), "result packer").count, 4);
}

// 8 bits for each row, and one for all of them.
TEST(ResultDelayArea, DelaysTheDisparityOfEachRow) {
  EXPECT_EQ(item_of(core(), "result delay").count, 0);
  expect_all("result delay", {{core(kResultDelay, 1), {0, 8 + 1}},
                              {core(kResultDelay, 16), {8 + 1}},
                              {core(kResultDelay, 17, kRows, 4), {2 * (4 * 8 + 1)}}});
  expect_all("result queue", {{core(kResultDelay, 64), all_of(core(), "result queue")}});
}

TEST(LanesArea, HasQueuesAndFiltersForEachLane) {
  for (const char* const name : {"slot sequencers", "table entry queues", "source addresses",
                                 "byte selectors", "pixel queues", "filters"}) {
    expect_all(name, {{core(kLanes, 4), 4 * all_of(core(), name)}});
    EXPECT_EQ(item_of(core(kLanes, 4), name).count, 4 * item_of(core(), name).count);
  }
  for (const char* const name : {"filter line memories", "window modules", "candidate marks",
                                 "select-min unit A", "left-right check", "result queue"})
    expect_all(name, {{core(kLanes, 4), all_of(core(), name)}});
  const CoreConfig joint = core(kLanes, 3, kJoint, true);
  expect_all("source positions", {{joint, 3 * all_of(core(kJoint, true), "source positions")}});
}

// A column of 7 slots takes 2 cycles of 4 pixels.
TEST(LanesArea, SumsTheDifferencesOfAllLanesByATree) {
  expect_all("right pixel delays", {{core(kLanes, 4), {79 * 4 * 8}}});
  // 4 differences, a tree of 2 adders of 9 bits and one of 10, and the sum.
  const Resources one = all_of(core(), "column modules");
  expect_all("column modules", {{core(kLanes, 4), one + 80 * Resources{3 * 32 + 2 * 9 + 10, 3 * 8}}});
  // With several rows each pixel moves the sum by one row. A lane keeps 2 of 7 differences.
  const Resources rows = all_of(core(kRows, 4), "column modules");
  expect_all("column modules",
             {{core(kRows, 4, kLanes, 4), rows + 80 * Resources{3 * (32 + 8 + 9 + 11), 3 * 8}}});
}

TEST(LanesArea, DividesTheSlotsOfAColumnAmongTheCaches) {
  const auto cache = [](int places) { return Resources{2 * (places * (18 + 32) + 18 + 9 + 32)}; };
  const Resources cache_of_one{2 * (18 + 9 + 32), 2 * (18 + 32)};
  expect_all("word caches", {{core(kCache, kWord, kWindow, 17, kLanes, 16), cache(1) + 15 * cache_of_one},
                             {core(kCache, kWord, kWindow, 31, kLanes, 1), cache(2)},
                             {core(kCache, kWord, kWindow, 31, kLanes, 2), 2 * cache(1)}});
}

TEST(JointTablesArea, HasQueuesOfDisplacementsAndAddsThePosition) {
  const CoreConfig joint = core(kJoint, true);
  expect_all("table entry queues", {{joint, 2 * Resources{3 * 16 + 28, 17}}});
  expect_all("source positions", {{joint, {2 * (10 + 9), 2 * 24}},
                                  {core(kJoint, true, kWidth, 512, kHeight, 513), {2 * (9 + 10), 2 * 24}}});
  expect_all("source addresses", {{joint, all_of(core(), "source addresses")}});
  EXPECT_EQ(item_of(core(), "source positions").count, 0);
}

// 640 x 480 / 4 words: 17 bits of address, and a valid bit.
TEST(WordCacheArea, KeepsAnAddressAndAWordForEachSlotOfAColumn) {
  const auto cache = [](int places) { return Resources{2 * (places * (18 + 32) + 18 + 9 + 32)}; };
  expect_all("word caches",
             {{core(kCache, kWord), cache(1)},
              {core(kCache, kWord, kRows, 4), cache(1)},  // 10 places
              {core(kCache, kWord, kWindow, 17), cache(2)},
              {core(kCache, kWord, kFetch, Fetch::kLineBuffer), {2 * (18 + 9 + 32), 2 * (18 + 32)}}});
  EXPECT_EQ(item_of(core(), "word caches").count, 0);
}

// Columns of squares: 7 * 255^2 takes 19 bits, 49 of them 22.
TEST(SsdArea, SquaresWithMultipliersAndSumsMoreBits) {
  expect_all("column modules", {{core(kCost, kSsd), 80 * Resources{9 + 19, 16 + 2 * 19, 0, 1}}});
  expect_all("window modules", {{core(kCost, kSsd), 80 * Resources{19 + 18 + 2 * 22, 2 * 22}}});
  expect_all("select-min unit A", {{core(kCost, kSsd, kDisparities, 2), {23 + 1 + 22 + 1, 23 + 24}}});
  expect_all("right pixel delays", {{core(kCost, kSsd), {79 * 8}}});
  EXPECT_EQ(all_of(core(kCost, kSsd, kFetch, Fetch::kLineBuffer), "column modules").multipliers, 80 * 7);
}

// 24 bits per pixel give 12 counts of 0..2. Their tree has 8 adders of 3 bits, 2 of 4 bits and 1 of 5.
TEST(CensusArea, CountsDifferentBitsInsteadOfDifferences) {
  constexpr int kPair = 24 + (4 * 3 + 4 * 3 + 2 * 4 + 5);
  expect_all("column modules", {{core(kCost, census(5)), 80 * Resources{kPair + 8, 5 + 2 * 8}}});
  expect_all("window modules", {{core(kCost, census(5)), 80 * Resources{8 + 7 + 2 * 11, 2 * 11}}});
  expect_all("right pixel delays", {{core(kCost, census(5)), {79 * 24}}});
  // 8 bits: 4 counts.
  expect_all("column modules", {{core(kCost, census(3)), 80 * Resources{8 + (2 * 3 + 4) + 6, 4 + 2 * 6}}});
}

TEST(CensusArea, ComparesEachPixelWithItsNeighbours) {
  constexpr int kKept = 5 * 4 * 8;
  expect_all("census bits",
             {{core(kCost, census(5)), 2 * Resources{24 * 9 + kKept, kKept + 16 * 8}},
              {core(kCost, census(5), kFetch, Fetch::kLineBuffer), 2 * Resources{24 * 9, kKept}},
              {core(kCost, census(3)), 2 * Resources{8 * 9 + 48, 48 + 32}}});
  for (const char* const name : {"census bits", "census columns", "census line memories"})
    EXPECT_EQ(item_of(core(), name).count, 0) << name;
}

TEST(CensusArea, KeepsRowsAndColumnsOfPixels) {
  // 4 and 6 rows of 8 bits.
  expect_all("census line memories", {{core(kCost, census(5)), block_rams(2 * 2)},
                                      {core(kCost, census(7)), block_rams(2 * 3)},
                                      {core(kCost, census(5), kWidth, 2048), block_rams(2 * 4)}});
  expect_all("census columns", {{core(kCost, census(5)), block_rams(2 * 1)},
                                {core(kCost, census(7)), block_rams(2 * 2)},
                                {core(kCost, census(5), kFetch, Fetch::kLineBuffer), {}}});
  // 6 rows of 24 bits; on the left also 3 + 2 valid bits.
  expect_all("row buffers", {{core(kCost, census(5), kFetch, Fetch::kLineBuffer, kFilter, std::nullopt),
                              block_rams(8 + 9)}});
}

// Windows of 7x7: N takes 6 bits, the sum of the pixels 14, of their squares or products 22, the variances
// 26. Products of longer numbers than 17 bits are made in parts.
constexpr Resources kVariance{11 + 26 + 7, 26, 0, 2 + 1};
constexpr Resources kScore{11 + 27 + 26 + 3 * 35, 53, 0, 2 + 1 + 4};
constexpr Resources kSelect{2 * (7 * 61) + 80 + 79, 0, 0, 2 * 8};

TEST(ZnccArea, SumsProductsInTheModules) {
  expect_all("column modules", {{core(kCost, kZncc), 80 * Resources{19, 16 + 2 * 19, 0, 1}}});
  expect_all("window modules", {{core(kCost, kZncc), 80 * Resources{19 + 18 + 2 * 22, 2 * 22}}});
}

TEST(ZnccArea, HasTheVariancesOfEachSideOnce) {
  const Resources sums{(11 + 19) + (49 + 81), 2 * (11 + 19) + 16 + 2 * (14 + 22), 0, 1};
  expect_all("window statistics", {{core(kCost, kZncc), 2 * (sums + kVariance)}});
  const Resources two_rows{(11 + 17) + (19 + 33) + 2 * (49 + 81), 2 * (11 + 19) + 16 + 4 * (14 + 22), 0, 1};
  expect_all("window statistics", {{core(kCost, kZncc, kRows, 2), 2 * (two_rows + 2 * kVariance)}});
  EXPECT_EQ(item_of(core(kCost, kZncc, kRows, 2), "window statistics").count, 4);
  expect_all("right statistics delays", {{core(kCost, kZncc), {0, 79 * 40}},
                                         {core(kCost, kZncc, kRows, 2), {0, 2 * 79 * 40}},
                                         {core(kCost, kZncc, kUnits, 40), {39 * 40 + 40 + 40}}});
}

TEST(ZnccArea, ComparesFractionsByTheirProducts) {
  expect_all("scores", {{core(kCost, kZncc), 80 * kScore},
                        {core(kCost, kZncc, kRows, 2), 160 * kScore},
                        {core(kCost, kZncc, kUnits, 40), 40 * kScore}});
  expect_all("select-min unit A",
             {{core(kCost, kZncc, kDisparities, 2), kSelect + Resources{1 + 1, 80 + 81}}});
  expect_all("select-min unit B", {{core(kCost, kZncc, kDisparities, 2), kSelect + Resources{1, 81}}});
  for (const char* const name : {"window statistics", "right statistics delays", "scores"})
    EXPECT_EQ(item_of(core(), name).count, 0) << name;
}

TEST(ZnccArea, HasSumsAsWideAsTheWindowMakesThem) {
  // 31x31: N 10 bits, sums 18 and 26, variances 34.
  EXPECT_EQ(
      all_of(core(kCost, kZncc, kWindow, 31, kDisparities, 1), "scores"),
      (Resources{(10 + 26 - 17) + 3 * (18 + 18 - 17) + 35 + 34 + 3 * (34 + 34 - 17), 69, 0, 2 + 4 + 4}));
}

}  // namespace
}  // namespace stereotlm::area
