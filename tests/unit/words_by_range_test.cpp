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

TEST(WordsByRange, CountsAllWithoutRanges) {
  WordsByRange words({});
  words.add(std::uint64_t{1} << 33U, 5);
  EXPECT_EQ(words.words(), Words{5});
}

}  // namespace
}  // namespace stereotlm
