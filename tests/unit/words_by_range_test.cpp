#include "models/words_by_range.h"

#include <gtest/gtest.h>

namespace stereotlm {
namespace {

using Words = std::vector<std::uint64_t>;

TEST(WordsByRange, CountsWordsOnBothSidesOfEachBorder) {
  WordsByRange words({{8, 16}, {16, 20}, {1024, 1028}});
  words.add(4, 2);
  EXPECT_EQ(words.words(), (Words{1, 0, 0, 1}));
  words.add(12, 3);
  EXPECT_EQ(words.words(), (Words{2, 1, 0, 2}));
  words.add(1024, 1);
  words.add(1028, 1);
  EXPECT_EQ(words.words(), (Words{2, 1, 1, 3}));
  EXPECT_EQ(words.total(), 7U);
}

TEST(WordsByRange, GoesBackToAnEarlierRange) {
  WordsByRange words({{0, 4}, {4, 8}});
  words.add(4, 1);
  words.add(0, 1);
  words.add(4, 1);
  EXPECT_EQ(words.words(), (Words{1, 2, 0}));
}

TEST(WordsByRange, CountsEachWordWhereItBegins) {
  const std::vector<AddressRange> ranges = {{40, 50}, {12, 21}, {50, 50}, {64, 68}, {70, 1000}};
  for (std::uint64_t address = 0; address < 100; ++address) {
    for (std::uint64_t count = 0; count < 40; ++count) {
      Words expected(ranges.size() + 1);
      for (std::uint64_t word = address; word < address + 4 * count; word += 4) {
        std::size_t range = 0;
        while (range < ranges.size() && !ranges[range].contains(word)) ++range;
        ++expected[range];
      }
      WordsByRange words(ranges);
      words.add(address, count);
      ASSERT_EQ(words.words(), expected) << address << ", " << count;
    }
  }
}

TEST(WordsByRange, CountsAllWithoutRanges) {
  WordsByRange words({});
  words.add(std::uint64_t{1} << 33U, 5);
  EXPECT_EQ(words.words(), Words{5});
}

}  // namespace
}  // namespace stereotlm
