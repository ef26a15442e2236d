#include "models/words_by_range.h"

#include <gtest/gtest.h>

namespace stereotlm {
namespace {

using Words = std::vector<std::uint64_t>;

TEST(WordsByRange, CountsEachWordInTheRangeInWhichItBegins) {
  const std::vector<AddressRange> some = {{40, 50}, {12, 21}, {50, 50}, {64, 68}, {70, 1000}};
  for (const auto& ranges : {some, std::vector<AddressRange>{}}) {
    WordsByRange words(ranges);
    Words expected(ranges.size() + 1);
    std::uint64_t total = 0;
    for (std::uint64_t address = 0; address < 100; ++address) {
      for (std::uint64_t count = 0; count < 40; ++count) {
        for (std::uint64_t word = address; word < address + 4 * count; word += 4) {
          std::size_t range = 0;
          while (range < ranges.size() && !ranges[range].contains(word)) ++range;
          ++expected[range];
        }
        words.add(address, count);
        ASSERT_EQ(words.words(), expected) << address << ", " << count;
        total += count;
      }
    }
    EXPECT_EQ(words.total(), total);
  }
}

TEST(WordsByRange, CountsWordsBeyondTheFirstFourGigabytes) {
  WordsByRange words({{std::uint64_t{1} << 33U, UINT64_MAX}});
  words.add(std::uint64_t{1} << 33U, 5);
  EXPECT_EQ(words.words(), (Words{5, 0}));
}

}  // namespace
}  // namespace stereotlm
