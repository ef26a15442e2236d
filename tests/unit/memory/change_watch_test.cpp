#include "models/memory/change_watch.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace stereotlm::memory {
namespace {

constexpr std::uint64_t kFirst = 0x100;
constexpr std::uint64_t kEnd = 0x140;

// Port 1 has asked for its words before.
class ChangeWatchTest : public testing::Test {
 protected:
  ChangeWatchTest() { EXPECT_TRUE(may_have_changed()); }
  bool may_have_changed() { return watch.may_have_changed(1, kFirst, kEnd); }

  ChangeWatch watch;
};

TEST_F(ChangeWatchTest, SeesNoChangeBetweenTwoCalls) { EXPECT_FALSE(may_have_changed()); }

TEST_F(ChangeWatchTest, SeesAChangeOfAnyOfItsWordsOnce) {
  struct Change {
    std::uint64_t first;
    std::uint64_t bytes;
    bool is_seen;
  };
  for (const Change& change :
       {Change{kFirst - 4, 4, false}, Change{kFirst - 4, 8, true}, Change{kFirst, 4, true},
        Change{kEnd - 4, 4, true}, Change{kEnd, 4, false}, Change{0, 0x1000, true}}) {
    watch.changes(change.first, change.bytes);
    watch.changes(0x2000, 4);  // a later change elsewhere
    EXPECT_EQ(may_have_changed(), change.is_seen) << change.first << ", " << change.bytes;
    EXPECT_FALSE(may_have_changed());
  }
}

TEST_F(ChangeWatchTest, TakesOtherWordsForChanged) {
  EXPECT_TRUE(watch.may_have_changed(1, kFirst, kEnd + 4));
  EXPECT_TRUE(watch.may_have_changed(1, kFirst + 4, kEnd + 4));
  EXPECT_TRUE(may_have_changed());
  EXPECT_FALSE(may_have_changed());
}

TEST_F(ChangeWatchTest, WatchesForEachPortByItself) {
  EXPECT_TRUE(watch.may_have_changed(2, kFirst, kEnd));
  watch.changes(kFirst, 4);
  EXPECT_TRUE(may_have_changed());
  EXPECT_TRUE(watch.may_have_changed(2, kFirst, kEnd));
}

}  // namespace
}  // namespace stereotlm::memory
