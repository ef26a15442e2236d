#include "sw/explore/plan/shuffled_numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace stereotlm::explore {
namespace {

std::vector<std::uint64_t> shuffled(std::uint64_t size, std::uint64_t seed, std::uint64_t first_places) {
  const ShuffledNumbers numbers(size, seed);
  std::vector<std::uint64_t> all;
  for (std::uint64_t place = 0; place < first_places; ++place) all.push_back(numbers.at(place));
  return all;
}

TEST(ShuffledNumbers, HoldEachNumberOnce) {
  for (const std::uint64_t size : {1U, 2U, 3U, 4U, 5U, 16U, 17U, 1000U, 4097U}) {
    std::vector<std::uint64_t> numbers = shuffled(size, 7, size);
    std::sort(numbers.begin(), numbers.end());
    for (std::uint64_t i = 0; i < size; ++i) ASSERT_EQ(numbers[i], i) << size;
  }
}

TEST(ShuffledNumbers, DependOnTheSeed) {
  const auto one = shuffled(100, 1, 100);
  EXPECT_EQ(shuffled(100, 1, 100), one);
  EXPECT_NE(shuffled(100, 2, 100), one);
  EXPECT_FALSE(std::is_sorted(one.begin(), one.end()));
}

TEST(ShuffledNumbers, PutEachNumberIntoTheFirstHalfForHalfOfTheSeeds) {
  constexpr std::uint64_t kSize = 10;
  constexpr std::uint64_t kSeeds = 2000;
  std::vector<int> early(kSize);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const std::uint64_t number : shuffled(kSize, seed, kSize / 2)) ++early[number];
  }
  for (const int times : early) EXPECT_NEAR(times, kSeeds / 2, 5 * 23) << "five standard deviations";
}

}  // namespace
}  // namespace stereotlm::explore
