#include "models/pci/posted_writes.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <utility>

#include "models/pci/bridge_registers.h"

namespace stereotlm::pci {
namespace {

using Words = std::vector<std::uint32_t>;

Words words_of(const PostedWrites::Burst& burst) { return {burst.words, burst.words + burst.count}; }

void push(PostedWrites& posted, std::uint64_t address, const Words& words) {
  posted.push(address, words.data(), words.size());
}

std::size_t waiting(const PostedWrites& posted) {
  std::size_t words = 0;
  for (const PostedWrites::Run& run : posted.waiting()) words += run.words;
  return words;
}

TEST(PostedWrites, SendsNeighboursTogetherUpToTheLongestBurst) {
  PostedWrites posted(8);
  push(posted, 100, {1, 2});
  push(posted, 108, {3, 4, 5});
  const auto first = posted.send(4);
  EXPECT_EQ(first.address, 100U);
  EXPECT_EQ(words_of(first), (Words{1, 2, 3, 4}));
  posted.sent();
  const auto second = posted.send(4);
  EXPECT_EQ(second.address, 116U);
  EXPECT_EQ(words_of(second), Words{5});
  posted.sent();
  EXPECT_FALSE(posted.waits());
}

TEST(PostedWrites, EndsABurstWhereTheAddressesJump) {
  PostedWrites posted(8);
  push(posted, 100, {1});
  push(posted, 200, {2});
  push(posted, 100, {3});
  for (const auto& [address, word] : {std::pair{100U, 1U}, std::pair{200U, 2U}, std::pair{100U, 3U}}) {
    const auto burst = posted.send(8);
    EXPECT_EQ(burst.address, address);
    EXPECT_EQ(words_of(burst), Words{word});
    posted.sent();
  }
}

TEST(PostedWrites, EndsABurstAtTheEndOfItsBank) {
  PostedWrites posted(8);
  push(posted, bridge::kBankBytes - 8, {1, 2, 3});
  EXPECT_EQ(words_of(posted.send(8)), (Words{1, 2}));
  posted.sent();
  const auto rest = posted.send(8);
  EXPECT_EQ(rest.address, bridge::kBankBytes);
  EXPECT_EQ(words_of(rest), Words{3});
}

TEST(PostedWrites, KeepsTheWordsThatAreSentUntilTheyHaveGone) {
  PostedWrites posted(4);
  push(posted, 0, {1, 2});
  const auto burst = posted.send(4);
  push(posted, 8, {3, 4});  // a neighbour too late
  EXPECT_EQ(words_of(burst), (Words{1, 2}));
  EXPECT_EQ(posted.words(), 4U);
  EXPECT_EQ(posted.words_being_sent(), 2U);
  EXPECT_EQ(waiting(posted), 2U);
  EXPECT_TRUE(posted.waits());
  posted.sent();
  EXPECT_EQ(posted.words(), 2U);
  EXPECT_EQ(posted.words_being_sent(), 0U);
  const auto next = posted.send(4);
  EXPECT_EQ(next.address, 8U);
  EXPECT_EQ(words_of(next), (Words{3, 4}));
  EXPECT_EQ(waiting(posted), 0U);
  EXPECT_FALSE(posted.waits());
}

// Against one entry per word.
TEST(PostedWrites, DoesAsAQueueOfWords) {
  constexpr std::size_t kPlaces = 24;
  std::mt19937 random(1);
  const auto below = [&random](unsigned end) { return static_cast<std::size_t>(random() % end); };
  PostedWrites posted(kPlaces);
  std::deque<std::pair<std::uint64_t, std::uint32_t>> plain;
  std::uint64_t next = bridge::kBankBytes - 400;
  std::uint32_t value = 0;
  std::size_t sending = 0;
  for (int i = 0; i < 20'000; ++i) {
    if (below(2) == 0 && plain.size() < kPlaces) {
      if (below(3) == 0) next = bridge::kBankBytes - 4 * below(20);
      Words words(1 + below(static_cast<unsigned>(kPlaces - plain.size())));
      for (std::uint32_t& word : words) word = ++value;
      push(posted, next, words);
      for (const std::uint32_t word : words) {
        plain.emplace_back(next, word);
        next += 4;
      }
    } else if (sending > 0) {
      posted.sent();
      plain.erase(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(sending));
      sending = 0;
    } else if (!plain.empty()) {
      const std::size_t most = 1 + below(10);
      Words expected;
      const std::uint64_t first = plain.front().first;
      while (expected.size() < std::min(most, plain.size()) &&
             plain[expected.size()].first == first + 4 * expected.size() &&
             plain[expected.size()].first / bridge::kBankBytes == first / bridge::kBankBytes) {
        expected.push_back(plain[expected.size()].second);
      }
      const auto burst = posted.send(most);
      ASSERT_EQ(burst.address, first);
      ASSERT_EQ(words_of(burst), expected);
      sending = burst.count;
    }
    ASSERT_EQ(posted.words(), plain.size());
    ASSERT_EQ(posted.words_being_sent(), sending);
    ASSERT_EQ(waiting(posted), plain.size() - sending);
  }
}

}  // namespace
}  // namespace stereotlm::pci
