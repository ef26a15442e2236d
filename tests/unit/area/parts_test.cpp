#include "models/area/parts.h"

#include <gtest/gtest.h>

#include <utility>

#include "tests/unit/area/resources.h"

namespace stereotlm::area {
namespace {

TEST(BitsOf, GrowAtEachPowerOfTwo) {
  const std::pair<std::int64_t, int> largest[] = {
      {0, 0}, {1, 1}, {255, 8}, {256, 9}, {(1LL << 40) - 1, 40}, {1LL << 40, 41}};
  for (const auto& [value, bits] : largest) EXPECT_EQ(bits_of(value), bits) << value;
}

TEST(BitsOf, HaveASignBitInARangeOfBothSigns) {
  const std::pair<Range, int> ranges[] = {{{0, 0}, 0},  {{0, 127}, 7},    {{-1, 0}, 1},     {{-256, 0}, 9},
                                          {{-1, 1}, 2}, {{-128, 127}, 8}, {{-129, 127}, 9}, {{-128, 128}, 9}};
  for (const auto& [range, bits] : ranges) EXPECT_EQ(bits_of(range), bits) << range.low << ".." << range.high;
}

TEST(Parts, TakeALutABit) {
  EXPECT_EQ(adder(12), (Resources{12}));
  EXPECT_EQ(selector(12), (Resources{12}));
  EXPECT_EQ(comparator(12), (Resources{13}));
  EXPECT_EQ(absolute_difference(8), (Resources{4 * 8}));
  EXPECT_EQ(registers(12), (Resources{0, 12}));
}

TEST(Multiplexer, TakesALutForTwoNumbers) {
  const std::pair<int, std::int64_t> cases[] = {{1, 0}, {2, 1}, {3, 2}, {4, 2}, {32, 16}, {33, 17 + 1}};
  for (const auto& [numbers, luts] : cases)
    EXPECT_EQ(multiplexer(numbers, 8), (Resources{8 * luts})) << numbers;
}

TEST(Equality, TakesALutForTwoBits) {
  EXPECT_EQ(equality(1), (Resources{1}));
  EXPECT_EQ(equality(2), (Resources{1}));
  EXPECT_EQ(equality(3), (Resources{2}));
}

TEST(AdderTree, WidensWithEachLevel) {
  EXPECT_EQ(adder_tree(1, 255), (Resources{}));
  EXPECT_EQ(adder_tree(2, 255), (Resources{9}));
  EXPECT_EQ(adder_tree(5, 255), (Resources{9 + (9 + 10) + 11}));  // 2 + (1 + 2)
}

TEST(Product, IsMadeInPartsOf17Bits) {
  EXPECT_EQ(product(17, 17), (Resources{0, 0, 0, 1}));
  EXPECT_EQ(product(18, 17), (Resources{18, 0, 0, 2}));
  EXPECT_EQ(product(17, 18), (Resources{18, 0, 0, 2}));
  EXPECT_EQ(product(34, 34), (Resources{3 * 51, 0, 0, 4}));
  EXPECT_EQ(product(35, 34), (Resources{5 * 52, 0, 0, 6}));
}

TEST(Digits, StandSideBySideIfTheRadixIsAPowerOfTwo) {
  EXPECT_EQ(digits(640, 19), (Resources{19, 0, 0, 1}));
  EXPECT_EQ(digits(512, 19), (Resources{}));
  EXPECT_EQ(digits(1, 7), (Resources{}));
}

TEST(ShiftRegister, IsAnSrl16UpToALengthOf16) {
  const std::pair<int, Resources> lengths[] = {{0, {}},    {1, {0, 9}}, {2, {9}},  {16, {9}},
                                               {17, {18}}, {64, {36}},  {65, {45}}};
  for (const auto& [length, resources] : lengths) EXPECT_EQ(shift_register(length, 9), resources) << length;
}

TEST(LutMemory, TakesTwoLutsABitForEach16Words) {
  const std::pair<int, std::int64_t> cases[] = {{1, 2}, {16, 2}, {17, 4}, {33, 8}, {64, 8}, {128, 16 + 1}};
  for (const auto& [words, luts] : cases) EXPECT_EQ(lut_memory(words, 9), (Resources{9 * luts})) << words;
}

TEST(Memory, IsMadeOfBlockRamsThatAreDeepEnough) {
  struct Case {
    int words;
    int bits;
    std::int64_t block_rams;
  };
  const Case cases[] = {
      {512, 36, 1}, {513, 36, 2},  {512, 37, 2},  {1024, 18, 1}, {1025, 18, 2},  {1024, 19, 2},
      {2048, 9, 1}, {2049, 9, 3},  {2048, 10, 2}, {4096, 4, 1},  {4097, 4, 2},   {8192, 2, 1},
      {8193, 2, 2}, {16384, 1, 1}, {16385, 1, 2}, {640, 54, 3},  {1028, 54, 6},  {1, 1, 1},
      {1, 36, 1},   {1, 0, 0},     {640, 94, 6},  {512, 94, 3},  {2048, 97, 11},
  };
  for (const Case& one : cases) {
    EXPECT_EQ(memory(one.words, one.bits), (Resources{0, 0, one.block_rams, 0}))
        << one.words << " x " << one.bits;
  }
}

TEST(Resources, AddAndMultiplyKindByKind) {
  EXPECT_EQ((Resources{1, 2, 3, 4} + Resources{10, 20, 30, 40}), (Resources{11, 22, 33, 44}));
  EXPECT_EQ((3 * Resources{1, 2, 3, 4}), (Resources{3, 6, 9, 12}));
}

}  // namespace
}  // namespace stereotlm::area
