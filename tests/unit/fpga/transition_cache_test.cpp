#include "models/fpga/transition_cache.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace stereotlm::fpga {
namespace {

// Groups of 10, 11, 12, .. cycles with a word each, one after the other; in each of them the result port is
// granted once more than in the one before.
class TransitionCacheTest : public testing::Test {
 protected:
  static constexpr std::uint64_t kMuch = UINT64_MAX / 2;
  static constexpr std::size_t kMost = 3000;

  static TransitionCache::State state(std::uint64_t number) {
    TransitionCache::State state;
    state.control.rest = number;
    return state;
  }
  static TransitionCache::Effect effect(std::size_t number) {
    TransitionCache::Effect effect;
    effect.progress = {10 + number, 4, 8, 8, 1};
    effect.counts[kResultPort].add(Intent::kRequest, true, number + 1);
    return effect;
  }
  void record(std::size_t from, std::size_t next, const TransitionCache::Accesses& accesses = {}) {
    groups_.record(groups_.number_of(state(from)), accesses, {}, groups_.number_of(state(next)),
                   effect(from));
  }
  // Of so many groups, the last of which continues with group number `back_to`.
  void make_ring(std::size_t groups, std::size_t back_to) {
    for (std::size_t i = 0; i < groups; ++i) record(i, i + 1 < groups ? i + 1 : back_to);
  }
  // The number of the group that comes next. Reduces `room`, and adds to `sequence`.
  std::uint64_t walk(std::size_t from, Progress& room, TransitionCache::Sequence* sequence = nullptr) {
    const auto last = groups_.walk(groups_.number_of(state(from)), {}, room, sequence);
    groups_.count_followed(control_, arbitration_);
    return groups_.state(last).control.rest;
  }
  std::uint64_t granted() const { return control_.port_cycles(kResultPort).granted(); }

  TransitionCache groups_{128, kMost};
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
        Progress room = {kMuch, kMuch, kMuch, kMuch, words};
        ASSERT_EQ(walk(0, room), at) << length << ' ' << back_to << ' ' << words;
        ASSERT_EQ(room.cycles, kMuch - cycles);
        ASSERT_EQ(room.words, 0U);
        ASSERT_EQ(granted(), grants);
      }
    }
  }
}

// Of 128 slots: the two words of each side.
TEST_F(TransitionCacheTest, DistinguishesTheSlotsThatAreNotHandled) {
  TransitionCache::State from = state(0);
  from.control.lanes = {3U << 8U, 64U << 8U};  // slots handled
  const auto number = groups_.number_of(from);
  groups_.record(number, {}, {}, number, effect(0));
  const auto finds = [&](std::size_t word, unsigned bit) {
    TransitionCache::Accesses accesses{};
    accesses[word] = std::uint64_t{1} << bit;
    return groups_.find(number, accesses).has_value();
  };
  EXPECT_EQ(groups_.words_of_side(), 2U);
  EXPECT_TRUE(finds(0, 2));
  EXPECT_FALSE(finds(0, 3));
  EXPECT_FALSE(finds(0, 63));
  EXPECT_FALSE(finds(1, 0));
  EXPECT_TRUE(finds(2, 63));
  EXPECT_FALSE(finds(3, 0));
  EXPECT_FALSE(finds(3, 63));
}

TEST_F(TransitionCacheTest, DistinguishesTheRequestsOfTheHost) {
  const auto number = groups_.number_of(state(0));
  TransitionCache::Effect granting = effect(0);
  granting.host = {5, 9, 7};
  groups_.record(number, {}, {3, 5, 7}, number, granting);
  const auto finds = [&](const HostRequests& host) { return groups_.find(number, {}, host).has_value(); };
  EXPECT_TRUE(finds({3, 5, 7}));
  EXPECT_FALSE(finds({4, 5, 7}));
  EXPECT_FALSE(finds({3, 6, 7}));
  EXPECT_FALSE(finds({3, 5, 6}));
  EXPECT_FALSE(finds({3, HostRequests::kEndless, 7}));
  EXPECT_FALSE(finds({}));
  groups_.record(number, {}, {}, number, effect(0));
  EXPECT_EQ(groups_.host(*groups_.find(number, {}, {3, 5, 7})), granting.host);
  EXPECT_EQ(groups_.host(*groups_.find(number, {})), HostGrants{});
}

// A ring of 3 groups with 1, 2 and 3 grants: 7 groups have 13 of them, and lead from the first to the second.
TEST_F(TransitionCacheTest, CountsASequenceAsItsTransitions) {
  make_ring(3, 0);
  const auto first = groups_.number_of(state(0));
  Progress room = {kMuch, kMuch, kMuch, kMuch, 7};
  TransitionCache::Sequence sequence;
  EXPECT_EQ(walk(0, room, &sequence), 1U);
  EXPECT_EQ(granted(), 13U);
  room.words = 1;
  EXPECT_EQ(walk(0, room), 1U);  // no part of the sequence
  EXPECT_EQ(granted(), 14U);

  const HostRequests host = {3, 5, 7, true};
  const Progress progress = {76, 28, 56, 56, 7};
  const HostGrants grants = {5, 76, 6};
  groups_.record_sequence(first, host, groups_.number_of(state(1)), progress, grants, sequence);
  EXPECT_FALSE(groups_.find(first, {}, {3, 5, 7, false}));
  EXPECT_FALSE(groups_.find(first, {}, {3, 4, 7, true}));
  const auto found = groups_.find(first, {}, host);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->next, groups_.number_of(state(1)));
  EXPECT_EQ(groups_.progress(*found), progress);
  EXPECT_EQ(groups_.host(*found), grants);
  for (int i = 0; i < 3; ++i) groups_.follow(*found);
  room.words = 1;
  walk(0, room);  // counts all
  EXPECT_EQ(granted(), 14U + 3 * 13 + 1);
}

TEST_F(TransitionCacheTest, KeepsTheOrderOfItsTransitions) {
  const auto cycles_of = [&](const TransitionCache::Sequence& parts) {
    std::vector<std::uint64_t> cycles;
    for (auto next = parts.begin(); next != parts.end(); next += next->length) {
      for (std::uint64_t time = 0; time < next->times; ++time) {
        for (auto part = next; part != next + next->length; ++part)
          cycles.push_back(groups_.progress(part->effect).cycles);
      }
    }
    return cycles;
  };
  for (const std::size_t back_to : {0U, 1U, 3U, 4U}) {
    groups_.clear();
    make_ring(5, back_to);
    std::vector<std::uint64_t> expected;
    for (std::size_t word = 0, at = 0; word < 123; ++word) {
      expected.push_back(10 + at);
      at = at + 1 < 5 ? at + 1 : back_to;
    }
    Progress room = {kMuch, kMuch, kMuch, kMuch, 123};
    TransitionCache::Sequence sequence;
    walk(0, room, &sequence);
    EXPECT_EQ(cycles_of(sequence), expected) << back_to;
    EXPECT_LT(sequence.size(), 40U);
    const HostRequests host = {3, 5, 7, true};
    groups_.record_sequence(groups_.number_of(state(0)), host, groups_.number_of(state(0)), {}, {}, sequence);
    const auto recorded = groups_.find(groups_.number_of(state(0)), {}, host);
    ASSERT_TRUE(recorded);
    EXPECT_EQ(cycles_of(groups_.parts(recorded->effect)), expected) << back_to;
  }
}

TEST_F(TransitionCacheTest, FindsEachTransitionAndIsFullAtItsCap) {
  for (std::size_t number = 0; number < kMost; ++number) {
    ASSERT_FALSE(groups_.is_full()) << number;
    record(number % 50, number % 30, {number, 0, 7, number});
  }
  EXPECT_TRUE(groups_.is_full());
  for (std::size_t number = 0; number < kMost; ++number) {
    const auto found = groups_.find(groups_.number_of(state(number % 50)), {number, 0, 7, number});
    ASSERT_TRUE(found) << number;
    EXPECT_EQ(groups_.state(found->next).control.rest, number % 30);
    EXPECT_EQ(groups_.progress(*found), effect(number % 50).progress);
  }
  groups_.clear();
  EXPECT_FALSE(groups_.is_full());
  EXPECT_FALSE(groups_.find(groups_.number_of(state(0)), {0, 0, 7, 0}));
}

TEST_F(TransitionCacheTest, IsFullWithTheMostPartsOfSequences) {
  record(0, 0);
  const auto number = groups_.number_of(state(0));
  const auto part = *groups_.find(number, {});
  TransitionCache::Sequence sequence;
  for (int i = 0; i < 100; ++i) groups_.follow(part, 1, &sequence);
  constexpr std::size_t kMostSequences = TransitionCache::kMostPartsEach * kMost / 100;
  for (std::uint16_t words = 1; words <= kMostSequences; ++words) {
    ASSERT_FALSE(groups_.is_full()) << words;
    groups_.record_sequence(number, {0, words, 0, true}, number, {}, {}, sequence);
  }
  EXPECT_TRUE(groups_.is_full());
  groups_.clear();
  EXPECT_FALSE(groups_.is_full());
}

// A clear cache knows nothing of the transitions that were followed before.
TEST_F(TransitionCacheTest, ForgetsWhatWasFollowedWhenItIsCleared) {
  make_ring(3, 0);
  groups_.follow(*groups_.find(groups_.number_of(state(2)), {}));
  groups_.clear();
  make_ring(1, 0);
  Progress room = {kMuch, kMuch, kMuch, kMuch, 5};
  walk(0, room);
  EXPECT_EQ(granted(), 5U);
}

}  // namespace
}  // namespace stereotlm::fpga
