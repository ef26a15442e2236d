#include "models/fpga/transition_cache.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace stereotlm::fpga {
namespace {

// Groups of 10, 11, 12, .. cycles with a word each, one behind the other; in each of them the result port is
// granted once more than in the one before.
class TransitionCacheTest : public testing::Test {
 protected:
  static constexpr std::uint64_t kMuch = UINT64_MAX / 2;

  TransitionCache::Group& group(std::size_t number) {
    TransitionCache::State state;
    state.control.rest = number;
    return groups_.at(state);
  }
  // Of so many groups, the last of which goes on with group number `back_to`.
  void make_ring(std::size_t groups, std::size_t back_to) {
    for (std::size_t i = 0; i < groups; ++i) {
      TransitionCache::Group& one = group(i);
      one.progress = {10 + i, 4, 8, 8, 1};
      one.counts[kResultPort].add(Intent::kRequest, true, i + 1);
      one.next = &group(i + 1 < groups ? i + 1 : back_to);
    }
  }
  // The number of the group that comes next.
  std::uint64_t walk(std::size_t from, const Progress& room) {
    progress_ = {};
    return groups_.walk(group(from), room, progress_, control_, arbitration_).begin->control.rest;
  }
  std::uint64_t granted() const { return control_.port_cycles(kResultPort).granted(); }

  TransitionCache groups_;
  Progress progress_;
  CoreControl control_{CoreConfig{}};
  memory::Arbitration arbitration_{core_arbiter(), std::vector<memory::SsramBankConfig>(6)};
};

// Rings of every length, entered in every place.
TEST_F(TransitionCacheTest, WalksARingAsIfGroupByGroup) {
  for (std::size_t length = 1; length <= 12; ++length) {
    for (std::size_t back_to = 0; back_to < length; ++back_to) {
      groups_.clear();
      make_ring(length, back_to);
      for (const std::uint64_t words : {0U, 1U, 5U, 11U, 12U, 13U, 100U, 12'345U}) {
        std::uint64_t cycles = 0;
        std::uint64_t grants = granted();
        std::size_t at = 0;
        for (std::uint64_t word = 0; word < words; ++word) {
          cycles += 10 + at;
          grants += at + 1;
          at = at + 1 < length ? at + 1 : back_to;
        }
        ASSERT_EQ(walk(0, {kMuch, kMuch, kMuch, kMuch, words}), at)
            << length << ' ' << back_to << ' ' << words;
        ASSERT_EQ(progress_.cycles, cycles);
        ASSERT_EQ(progress_.words, words);
        ASSERT_EQ(granted(), grants);
      }
    }
  }
}

TEST_F(TransitionCacheTest, IsFullAtItsCap) {
  for (std::size_t number = 0; number < TransitionCache::kMost; ++number) {
    ASSERT_FALSE(groups_.is_full()) << number;
    group(number);
  }
  EXPECT_TRUE(groups_.is_full());
  groups_.clear();
  EXPECT_FALSE(groups_.is_full());
}

}  // namespace
}  // namespace stereotlm::fpga
