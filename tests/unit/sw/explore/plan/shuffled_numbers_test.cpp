#include "sw/explore/plan/shuffled_numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

namespace stereotlm::explore {
namespace {

std::vector<std::uint64_t> shuffled(std::uint64_t size, std::uint64_t seed) {
  const ShuffledNumbers numbers(size, seed);
  std::vector<std::uint64_t> all;
  for (std::uint64_t place = 0; place < size; ++place) all.push_back(numbers.at(place));
  return all;
}

TEST(ShuffledNumbers, HoldEachNumberOnce) {
  for (const std::uint64_t size : {1U, 2U, 3U, 4U, 5U, 16U, 17U, 1000U, 4097U}) {
    std::vector<std::uint64_t> numbers = shuffled(size, 7);
    std::sort(numbers.begin(), numbers.end());
    for (std::uint64_t i = 0; i < size; ++i) ASSERT_EQ(numbers[i], i) << size;
  }
}

TEST(ShuffledNumbers, AreOfTheirSeed) {
  EXPECT_EQ(shuffled(100, 1), shuffled(100, 1));
  EXPECT_NE(shuffled(100, 1), shuffled(100, 2));
  EXPECT_FALSE(std::is_sorted(shuffled(100, 1).begin(), shuffled(100, 1).end()));
}

// Each number is as often in the first half as in the second.
TEST(ShuffledNumbers, PreferNoNumber) {
  constexpr std::uint64_t kSize = 10;
  constexpr int kSeeds = 2000;
  std::vector<int> early(kSize);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ShuffledNumbers numbers(kSize, static_cast<std::uint64_t>(seed));
    for (std::uint64_t place = 0; place < kSize / 2; ++place) ++early[numbers.at(place)];
  }
  for (const int times : early) EXPECT_NEAR(times, kSeeds / 2, 5 * 23) << "five standard deviations";
}

TEST(ShuffledNumbers, ReachFarBeyondMemory) {
  const std::uint64_t size = std::uint64_t{1} << 62U;
  const ShuffledNumbers numbers(size, 3);
  std::set<std::uint64_t> seen;
  for (std::uint64_t place = 0; place < 1000; ++place) {
    const std::uint64_t number = numbers.at(place);
    EXPECT_LT(number, size);
    seen.insert(number);
  }
  EXPECT_EQ(seen.size(), 1000U);
}

}  // namespace
}  // namespace stereotlm::explore
