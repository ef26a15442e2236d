#include "models/area/area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "tests/unit/area/resources.h"

namespace stereotlm::area {
namespace {

using fpga::CoreConfig;
using fpga::Fetch;

// That of this name; a count of 0 if there is none.
Item item_of(const CoreConfig& config, const std::string& name) {
  for (const Item& item : items(config)) {
    if (item.name == name) return item;
  }
  return {};
}

Resources all_of(const CoreConfig& config, const std::string& name) { return item_of(config, name).all; }

CoreConfig with_window(int window) {
  CoreConfig config;
  config.window = window;
  return config;
}

CoreConfig with_disparities(int disparities) {
  CoreConfig config;
  config.disparities = disparities;
  return config;
}

CoreConfig with_line_buffer() {
  CoreConfig config;
  config.fetch = Fetch::kLineBuffer;
  return config;
}

TEST(AreaItems, OfThePapersBoard) {
  std::vector<std::pair<std::string, std::int64_t>> found;
  for (const Item& item : items(CoreConfig())) found.emplace_back(item.name, item.count);
  const std::vector<std::pair<std::string, std::int64_t>> expected = {
      {"table entry queues", 2},
      {"source addresses", 2},
      {"byte selectors", 2},
      {"pixel queues", 2},
      {"filters", 2},
      {"filter columns", 2},
      {"filter line memories", 2},
      {"right pixel delays", 79},
      {"column modules", 80},
      {"window modules", 80},
      {"candidate marks", 80},
      {"select-min unit A", 80},
      {"select-min unit B", 79},
      {"left-right check", 1},
      {"result packer", 1},
      {"result queue", 1},
  };
  EXPECT_EQ(found, expected);
}

TEST(AreaItems, AreRefusedForACoreWithProblems) {
  CoreConfig config;
  config.window = 8;
  try {
    items(config);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "window = 8: must be 3..31, odd");
  }
}

// The most that n pixel differences add up to, and n columns of them.
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
  for (const SumBits& bits : kSumBits) {
    EXPECT_EQ(all_of(with_window(bits.window), "column modules"),
              80 * (Resources{17 + bits.column, bits.column}))
        << bits.window;
  }
}

TEST(ColumnModules, OfALineBufferAddUpAWholeColumn) {
  CoreConfig config = with_line_buffer();
  config.window = 3;  // 1 + 2: adders of 9 and 10 bits
  EXPECT_EQ(all_of(config, "column modules"), 80 * (Resources{3 * 17 + 9 + 10, 10}));
  config.window = 7;  // 3 + 4: (1 + 2) + (2 + 2)
  EXPECT_EQ(all_of(config, "column modules"), 80 * (Resources{7 * 17 + (9 + 10) + (9 + 9 + 10) + 11, 11}));
}

TEST(WindowModules, TakeAShiftRegisterADifferenceAndAnAccumulator) {
  for (const SumBits& bits : kSumBits) {
    const int srls = bits.window <= 16 ? 1 : 2;
    const Resources one{srls * bits.column + (bits.column + 1) + bits.window_sum, bits.window_sum};
    EXPECT_EQ(all_of(with_window(bits.window), "window modules"), 80 * one) << bits.window;
    CoreConfig line_buffer = with_window(bits.window);
    line_buffer.fetch = Fetch::kLineBuffer;
    EXPECT_EQ(all_of(line_buffer, "window modules"), 80 * one) << bits.window;
  }
}

TEST(RightPixelDelays, AreOneColumnEach) {
  EXPECT_EQ(all_of(with_window(15), "right pixel delays"), (Resources{79 * 8}));
  EXPECT_EQ(all_of(with_window(17), "right pixel delays"), (Resources{79 * 16}));
  EXPECT_EQ(all_of(with_line_buffer(), "right pixel delays"), (Resources{0, 79 * 7 * 8}));
  EXPECT_EQ(item_of(with_disparities(1), "right pixel delays").count, 0);
}

TEST(Modules, AreAsManyAsDisparities) {
  for (const char* const name : {"column modules", "window modules", "candidate marks"}) {
    const Resources one = all_of(with_disparities(1), name);
    for (const int disparities : {2, 80, 160, 254})
      EXPECT_EQ(all_of(with_disparities(disparities), name), disparities * one) << name;
  }
  EXPECT_EQ(all_of(with_disparities(1), "candidate marks"), (Resources{0, 1}));
}

// Windows of 7x7: sums of 14 bits. What every comparison takes: comparator, decision, selector.
constexpr int kComparison = 15 + 1 + 14;

TEST(SelectMinUnitA, IsAChainWhoseDisparitiesWiden) {
  EXPECT_EQ(all_of(with_disparities(1), "select-min unit A"), (Resources{0, 15}));
  EXPECT_EQ(all_of(with_disparities(2), "select-min unit A"), (Resources{kComparison + 1, 15 + 16}));
  // Module 127 hands on 7 bits, module 128 one more.
  const auto last_of = [](int disparities) {
    const Resources chain = all_of(with_disparities(disparities), "select-min unit A");
    const Resources before = all_of(with_disparities(disparities - 1), "select-min unit A");
    return Resources{chain.luts - before.luts, chain.flip_flops - before.flip_flops};
  };
  EXPECT_EQ(last_of(128), (Resources{kComparison + 7, 15 + 7}));
  EXPECT_EQ(last_of(129), (Resources{kComparison + 8, 15 + 8}));
}

TEST(SelectMinUnitB, IsATreeOfOneComparatorLessThanDisparities) {
  EXPECT_EQ(item_of(with_disparities(1), "select-min unit B").count, 0);
  EXPECT_EQ(all_of(with_disparities(2), "select-min unit B"), (Resources{kComparison, 16}));
  // 4 comparisons of single disparities, 2 of pairs, 1 of fours.
  EXPECT_EQ(all_of(with_disparities(8), "select-min unit B"),
            (Resources{7 * kComparison + 2 * 1 + 1 * 2, 4 * 16 + 2 * 17 + 1 * 18}));
  // 5: 2 pairs, one waits; 1 pair, one waits; 1 pair.
  EXPECT_EQ(item_of(with_disparities(5), "select-min unit B").count, 4);
  EXPECT_EQ(all_of(with_disparities(5), "select-min unit B"),
            (Resources{4 * kComparison + 1 + 2, (2 * 16 + 15) + (17 + 16) + 18}));
}

TEST(LeftRightCheck, DelaysTheLeftBasedDisparities) {
  // 17 disparities: 5 bits and a valid bit wait 16 columns; a difference of 5 bits, its tolerance, the
  // decision.
  constexpr int kCheck = 1 + (6 + 5) + 2 + 1 + 8;
  EXPECT_EQ(all_of(with_disparities(17), "left-right check"), (Resources{6 + kCheck, 0, 1, 0}));
  EXPECT_EQ(all_of(with_disparities(18), "left-right check"), (Resources{2 * 6 + kCheck, 0, 1, 0}));
  // 16 disparities: 4 bits, whose tolerance one LUT sees.
  EXPECT_EQ(all_of(with_disparities(16), "left-right check"),
            (Resources{5 + 1 + (5 + 4) + 1 + 1 + 8, 0, 1, 0}));
}

TEST(LeftRightCheck, CostsTheSameWithEveryTolerance) {
  CoreConfig tolerant;
  tolerant.lr_tolerance = 253;
  EXPECT_EQ(all_of(tolerant, "left-right check"), all_of(CoreConfig(), "left-right check"));
}

TEST(LeftRightCheck, WithoutItThereIsNoUnitA) {
  CoreConfig off;
  off.lr_tolerance.reset();
  EXPECT_EQ(item_of(off, "select-min unit A").count, 0);
  EXPECT_EQ(all_of(off, "left-right check"), (Resources{5 * 8 + 1 + 8}));
}

TEST(LeftRightCheck, DelaysTheValidBitOfItsOwnPixel) {
  // 3 columns of the window, 3 of the filter.
  CoreConfig config;
  const std::int64_t with_table = all_of(config, "left-right check").luts;
  config.right_table = false;
  EXPECT_EQ(all_of(config, "left-right check").luts, with_table);
  config.left_table = false;
  EXPECT_EQ(all_of(config, "left-right check").luts, with_table - 1);
  CoreConfig far = with_window(27);  // 13 + 3
  const std::int64_t sixteen = all_of(far, "left-right check").luts;
  far.window = 29;  // 14 + 3
  EXPECT_EQ(all_of(far, "left-right check").luts, sixteen + 1);
}

TEST(Lanes, HaveQueuesOfTableEntriesAndOfPixels) {
  CoreConfig config;
  for (const auto& [slots, luts] : {std::pair{2, 1}, {16, 1}, {17, 2}, {64, 4}}) {
    config.lane_fifo_slots = slots;
    EXPECT_EQ(all_of(config, "table entry queues"), (Resources{2 * 23 * luts})) << slots;
    EXPECT_EQ(all_of(config, "pixel queues"), (Resources{(9 + 8) * luts})) << slots;
  }
  config.lane_fifo_slots = 1;
  EXPECT_EQ(all_of(config, "table entry queues"), (Resources{0, 2 * 23}));
  EXPECT_EQ(all_of(config, "pixel queues"), (Resources{0, 9 + 8}));
}

TEST(Lanes, NeedTableEntriesOnlyForTables) {
  CoreConfig config;
  config.right_table = false;
  EXPECT_EQ(item_of(config, "table entry queues").count, 1);
  EXPECT_EQ(all_of(config, "pixel queues"), (Resources{9 + 8}));
  config.left_table = false;
  EXPECT_EQ(item_of(config, "table entry queues").count, 0);
  EXPECT_EQ(item_of(config, "source addresses").count, 0);
  EXPECT_EQ(all_of(config, "pixel queues"), (Resources{8 + 8}));
  EXPECT_EQ(all_of(config, "byte selectors"), (Resources{2 * 16}));
}

TEST(Lanes, MultiplyRowsByAWidthThatIsNoPowerOfTwo) {
  CoreConfig config;  // 640 x 480 - 1 in 19 bits
  EXPECT_EQ(all_of(config, "source addresses"), (Resources{2 * 19, 0, 0, 2}));
  config.height = 820;  // 524,800 pixels
  EXPECT_EQ(all_of(config, "source addresses"), (Resources{2 * 20, 0, 0, 2}));
  for (const int width : {4, 512, 2048}) {
    config.width = width;
    EXPECT_EQ(all_of(config, "source addresses"), (Resources{})) << width;
  }
  config.width = 516;
  EXPECT_EQ(all_of(config, "source addresses").multipliers, 2);
}

TEST(Results, WaitForWholeWordsAndForTheirBank) {
  CoreConfig config;
  EXPECT_EQ(all_of(config, "result packer"), (Resources{0, 24}));
  for (const auto& [words, luts] : {std::pair{2, 32}, {16, 32}, {17, 64}}) {
    config.result_fifo_words = words;
    EXPECT_EQ(all_of(config, "result queue"), (Resources{luts})) << words;
  }
  config.result_fifo_words = 1;
  EXPECT_EQ(all_of(config, "result queue"), (Resources{0, 32}));
}

TEST(Filter, IsThereTwice) {
  CoreConfig config;
  EXPECT_EQ(all_of(config, "filters"), (Resources{2 * 259, 2 * 94, 0, 2 * 10}));
  config.filter.reset();
  for (const char* const name : {"filters", "filter columns", "filter line memories"})
    EXPECT_EQ(item_of(config, name).count, 0) << name;
}

TEST(Filter, KeepsTheColumnsBeforeInBlockRamOrRegisters) {
  // 6 columns of 7 pixels: 48 bits in memories of 36.
  EXPECT_EQ(all_of(CoreConfig(), "filter columns"), (Resources{0, 0, 2 * 2, 0}));
  EXPECT_EQ(all_of(with_line_buffer(), "filter columns"), (Resources{0, 2 * 48}));
}

TEST(Filter, HasLineMemoriesOfTheWidthOfTheImage) {
  CoreConfig config;  // 94 bits
  for (const auto& [width, block_rams] : {std::pair{512, 3}, {516, 6}, {1024, 6}, {1028, 11}, {2048, 11}}) {
    config.width = width;
    EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 2 * block_rams, 0})) << width;
  }
}

TEST(Filter, KeepsValidBitsOfRowsThatTheColumnNoLongerHas) {
  CoreConfig config;
  config.filter = kernels::FilterKernel{31, std::vector<int>(961, 0), 0};
  config.filter->weights[0] = 1;
  config.filter->weights[960] = -1;
  config.width = 512;
  // 30 sums of 8 bits, 240; with windows of 7 the middle of the left one is 12 rows above the newest 7.
  EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 7 + 7, 0}));
  config.filter->weights[960] = 0;
  config.filter->weights[959] = -1;
  EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 7 + 7, 0}));
  config.filter->weights[959] = 0;
  config.filter->weights[929] = -1;  // the last sum is one of both signs: 241 bits
  EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 8 + 7, 0}));
  config.left_table = false;
  EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 7 + 7, 0}));
  config.left_table = true;
  config.window = 31;
  EXPECT_EQ(all_of(config, "filter line memories"), (Resources{0, 0, 7 + 7, 0}));
}

TEST(RowBuffers, AreThereForTheLineBufferOnly) {
  EXPECT_EQ(item_of(CoreConfig(), "row buffers").count, 0);
  CoreConfig config = with_line_buffer();
  config.filter.reset();
  // 6 rows of 8 bits: 48, and on the left 3 valid bits.
  for (const auto& [width, block_rams] : {std::pair{512, 2}, {516, 3}, {1024, 3}, {1028, 6}}) {
    config.width = width;
    EXPECT_EQ(all_of(config, "row buffers"), (Resources{0, 0, 2 * block_rams, 0})) << width;
  }
}

TEST(RowBuffers, HoldTheValidBitsOfTheLeftTable) {
  CoreConfig config = with_line_buffer();
  config.width = 2048;
  config.window = 3;
  config.filter.reset();
  // 2 rows of 8 bits and 1 valid bit: two memories of 9 bits. With the filter 4 valid bits.
  EXPECT_EQ(all_of(config, "row buffers"), (Resources{0, 0, 2 + 2, 0}));
  config.filter = kernels::log7();
  EXPECT_EQ(all_of(config, "row buffers"), (Resources{0, 0, 3 + 2, 0}));
  config.left_table = false;
  EXPECT_EQ(all_of(config, "row buffers"), (Resources{0, 0, 2 + 2, 0}));
}

// A core that is larger in one thing is smaller in none.
void expect_growth(std::vector<CoreConfig> configs) {
  Area before;
  for (const CoreConfig& config : configs) {
    const Area area = total(items(config), kDevices[0]);
    const std::string which = "window " + std::to_string(config.window) + ", disparities " +
                              std::to_string(config.disparities) + ", width " + std::to_string(config.width);
    EXPECT_GE(area.slices, before.slices) << which;
    EXPECT_GE(area.luts, before.luts) << which;
    EXPECT_GE(area.flip_flops, before.flip_flops) << which;
    EXPECT_GE(area.block_rams, before.block_rams) << which;
    before = area;
  }
  const Area least = total(items(configs.front()), kDevices[0]);
  EXPECT_GT(before.slices + before.block_rams, least.slices + least.block_rams);
}

void expect_growth_in(const std::function<std::vector<CoreConfig>(const CoreConfig&)>& series) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    for (const bool filter : {false, true}) {
      CoreConfig config;
      config.fetch = fetch;
      if (!filter) config.filter.reset();
      expect_growth(series(config));
    }
  }
}

TEST(AreaItems, GrowWithTheDisparities) {
  expect_growth_in([](CoreConfig config) {
    std::vector<CoreConfig> series;
    for (config.disparities = 1; config.disparities <= 254; ++config.disparities) series.push_back(config);
    return series;
  });
}

TEST(AreaItems, GrowWithTheWindow) {
  expect_growth_in([](CoreConfig config) {
    std::vector<CoreConfig> series;
    for (config.window = 3; config.window <= 31; config.window += 2) series.push_back(config);
    return series;
  });
}

TEST(AreaItems, GrowWithTheQueues) {
  expect_growth_in([](CoreConfig config) {
    std::vector<CoreConfig> series;
    for (int places = 2; places <= 64; ++places) {
      config.lane_fifo_slots = places;
      config.result_fifo_words = places;
      series.push_back(config);
    }
    return series;
  });
}

TEST(AreaItems, BlockRamsGrowWithTheWidth) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    CoreConfig config;
    config.fetch = fetch;
    std::int64_t before = 0;
    for (config.width = 4; config.width <= 2048; config.width += 4) {
      const std::int64_t block_rams = total(items(config), kDevices[0]).block_rams;
      EXPECT_GE(block_rams, before) << config.width;
      before = block_rams;
    }
  }
}

}  // namespace
}  // namespace stereotlm::area
