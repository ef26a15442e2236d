#include "models/capture/capture_fifo.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::capture {
namespace {

constexpr std::uint64_t kBegin = 1'000'000;

// 16 x 3 pixels, 4 words a line; a FIFO of 4 words that asks with 2.
class CaptureFifoTest : public testing::Test {
 protected:
  void build(const CaptureBoardConfig& config) {
    fifo.emplace(config);
    fifo->begin_frame(timing, kBegin);
  }
  std::uint64_t pixel_ps(int column, int row) const { return kBegin + timing.pixel_ps(column, row); }
  std::uint64_t word_ps(int word, int row) const { return pixel_ps(4 * word + 3, row); }
  int granted(std::uint64_t time_ps) {
    fifo->advance(time_ps);
    fifo->grant(burst);
    int words = 0;
    for (const LineWords& line : burst) words += line.count;
    return words;
  }
  // All words of a burst leave at one time.
  void leave_at(std::uint64_t time_ps, int words) {
    fifo->leave(time_ps, words, [=](std::uint64_t now) { return now < time_ps ? 0 : words; });
  }

  CameraTiming timing{{16, 3, 29.97, CameraTrigger::kFreeRunning}};
  std::optional<CaptureFifo> fifo;
  std::vector<LineWords> burst;
};

TEST_F(CaptureFifoTest, AsksWhenTheTriggerIsReachedExactly) {
  for (int trigger = 1; trigger <= 4; ++trigger) {
    build({4, trigger});
    fifo->advance(kBegin);
    EXPECT_EQ(fifo->next_ps(), word_ps(trigger - 1, 0)) << trigger;
    fifo->advance(word_ps(trigger - 1, 0) - 1);
    EXPECT_EQ(fifo->next_ps(), word_ps(trigger - 1, 0)) << trigger;
    fifo->advance(word_ps(trigger - 1, 0));
    EXPECT_EQ(fifo->next_ps(), word_ps(trigger - 1, 0)) << trigger;
  }
}

TEST_F(CaptureFifoTest, AsksAtTheEndOfALineBelowTheTrigger) {
  build({8, 5});
  fifo->advance(kBegin);
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 0));
  fifo->advance(word_ps(3, 0));
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 0));
  EXPECT_EQ(granted(word_ps(3, 0)), 4);
}

TEST_F(CaptureFifoTest, GrantsAWordFromTheArrivalOfItsLastPixelOn) {
  for (int word = 1; word < 4; ++word) {
    build({8, 1});
    EXPECT_EQ(granted(word_ps(word, 0) - 1), word) << word;
    build({8, 1});
    EXPECT_EQ(granted(word_ps(word, 0)), word + 1) << word;
  }
}

TEST_F(CaptureFifoTest, DropsThePixelThatFindsItFullAndTheLaterOnesOfItsLineAsTheyArrive) {
  build({2, 1});
  for (int column = 8; column < 16; ++column) {
    fifo->advance(pixel_ps(column, 0) - 1);
    EXPECT_EQ(fifo->dropped_pixels(), static_cast<std::uint64_t>(column - 8));
    fifo->advance(pixel_ps(column, 0));
    EXPECT_EQ(fifo->dropped_pixels(), static_cast<std::uint64_t>(column - 7));
  }
  fifo->advance(pixel_ps(0, 1) - 1);
  EXPECT_EQ(fifo->dropped_pixels(), 8U);
}

TEST_F(CaptureFifoTest, CountsTheWordThatIsBeingFilled) {
  // Pixel 4 finds the one word of the FIFO complete, pixel 5 would find it so too: there is no half place.
  build({1, 1});
  fifo->advance(pixel_ps(3, 0));
  EXPECT_EQ(fifo->dropped_pixels(), 0U);
  fifo->advance(pixel_ps(4, 0));
  EXPECT_EQ(fifo->dropped_pixels(), 1U);
  EXPECT_EQ(granted(pixel_ps(5, 0)), 1);
}

TEST_F(CaptureFifoTest, HasRoomForAPixelWhenAWordLeavesAtItsArrivalButNotLater) {
  build({2, 1});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(pixel_ps(8, 0), 1);
  EXPECT_EQ(fifo->dropped_pixels(), 0U);
  build({2, 1});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(pixel_ps(8, 0) + 1, 1);
  EXPECT_EQ(fifo->dropped_pixels(), 1U);
}

TEST_F(CaptureFifoTest, DropsTheRestOfTheLineEvenIfWordsLeave) {
  build({2, 1});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(pixel_ps(8, 0) + 1, 1);
  EXPECT_EQ(granted(pixel_ps(0, 1) - 1), 1);
  EXPECT_EQ(burst.at(0).first, 1);
  EXPECT_EQ(fifo->dropped_pixels(), 8U);
}

TEST_F(CaptureFifoTest, FollowsThePixelsOfALongBurstWordByWord) {
  // One word leaves just when each new one begins: the FIFO of two words stays full and drops nothing.
  build({2, 1});
  ASSERT_EQ(granted(word_ps(1, 0)), 2);
  fifo->leave(pixel_ps(12, 0), 2, [&](std::uint64_t now) {
    return (now >= pixel_ps(8, 0) ? 1 : 0) + (now >= pixel_ps(12, 0) ? 1 : 0);
  });
  EXPECT_EQ(fifo->dropped_pixels(), 0U);
  // The second leaves 1 ps too late.
  build({2, 1});
  ASSERT_EQ(granted(word_ps(1, 0)), 2);
  fifo->leave(pixel_ps(12, 0) + 1, 2, [&](std::uint64_t now) {
    return (now >= pixel_ps(8, 0) ? 1 : 0) + (now > pixel_ps(12, 0) ? 1 : 0);
  });
  EXPECT_EQ(fifo->dropped_pixels(), 1U);
}

TEST_F(CaptureFifoTest, GrantsTheWordsOfSeveralLinesInOneBurst) {
  build({12, 1});
  EXPECT_EQ(granted(word_ps(1, 2)), 10);
  ASSERT_EQ(burst.size(), 3U);
  EXPECT_EQ(burst[1].row, 1);
  EXPECT_EQ(burst[1].count, 4);
  EXPECT_EQ(burst[2].count, 2);
}

TEST_F(CaptureFifoTest, EndsABurstWhereTheAddressesJump) {
  build({3, 1});
  ASSERT_EQ(granted(word_ps(2, 0)), 3);
  leave_at(pixel_ps(0, 1), 1);  // too late for word 3 of line 0
  EXPECT_EQ(fifo->dropped_pixels(), 4U);
  EXPECT_EQ(granted(word_ps(0, 1)), 2);  // of line 0; word 0 of line 1 is elsewhere
  leave_at(word_ps(0, 1), 2);
  EXPECT_EQ(fifo->next_ps(), word_ps(0, 1));  // it was in the FIFO at the grant
  EXPECT_EQ(granted(word_ps(0, 1)), 1);
  EXPECT_EQ(burst.at(0).row, 1);
}

TEST_F(CaptureFifoTest, AsksAtOnceForWhatWasGrantedAndNotTaken) {
  build({4, 3});
  ASSERT_EQ(granted(word_ps(2, 0)), 3);
  leave_at(pixel_ps(12, 0), 2);
  EXPECT_EQ(fifo->next_ps(), pixel_ps(12, 0));
  ASSERT_EQ(granted(pixel_ps(12, 0)), 1);
  leave_at(pixel_ps(13, 0), 0);  // a retry
  EXPECT_EQ(fifo->next_ps(), pixel_ps(13, 0));
}

TEST_F(CaptureFifoTest, WaitsForTheTriggerWithWordsThatCameAfterTheGrant) {
  build({8, 3});
  ASSERT_EQ(granted(word_ps(1, 0)), 2);
  leave_at(word_ps(2, 0), 2);
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 0));  // the end of the line: 2 words
  build({8, 2});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(word_ps(1, 0), 1);
  EXPECT_EQ(fifo->next_ps(), word_ps(2, 0));
}

TEST_F(CaptureFifoTest, AsksAtTheEndOfABurstIfTheTriggerWasReachedMeanwhile) {
  build({8, 2});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(word_ps(2, 0), 1);
  EXPECT_EQ(fifo->next_ps(), word_ps(2, 0));
}

TEST_F(CaptureFifoTest, AsksAtTheEndOfABurstIfALineEndedMeanwhile) {
  build({8, 2});
  ASSERT_EQ(granted(word_ps(2, 0)), 3);
  leave_at(word_ps(3, 0) + 10, 3);
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 0) + 10);
}

TEST_F(CaptureFifoTest, HasNothingToAskForBetweenLines) {
  build({8, 2});
  ASSERT_EQ(granted(word_ps(3, 0)), 4);
  leave_at(word_ps(3, 0) + 10, 4);
  EXPECT_EQ(fifo->next_ps(), std::nullopt);
  fifo->advance(pixel_ps(0, 1));
  EXPECT_EQ(fifo->next_ps(), word_ps(1, 1));
}

TEST_F(CaptureFifoTest, HasNothingToAskForInALineWhoseRestIsDropped) {
  build({2, 2});
  ASSERT_EQ(granted(word_ps(1, 0)), 2);
  leave_at(pixel_ps(9, 0), 2);
  ASSERT_EQ(fifo->dropped_pixels(), 2U);
  EXPECT_EQ(fifo->next_ps(), std::nullopt);
}

TEST_F(CaptureFifoTest, FinishesWithTheLastWord) {
  build({12, 12});
  fifo->advance(word_ps(3, 2));
  EXPECT_FALSE(fifo->finished());
  ASSERT_EQ(granted(word_ps(3, 2)), 12);
  leave_at(word_ps(3, 2) + 10, 11);
  EXPECT_FALSE(fifo->finished());
  ASSERT_EQ(granted(word_ps(3, 2) + 20), 1);
  leave_at(word_ps(3, 2) + 30, 1);
  EXPECT_TRUE(fifo->finished());
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 2) + 30);
}

TEST_F(CaptureFifoTest, AsksNextAsLongAsWordsAreInItOrCome) {
  build({4, 4});
  fifo->advance(kBegin);
  EXPECT_FALSE(fifo->finishes_next());
  for (int row = 0; row < 2; ++row) {
    ASSERT_EQ(granted(word_ps(3, row)), 4);
    leave_at(word_ps(3, row) + 10, 4);
  }
  fifo->advance(pixel_ps(0, 2) - 1);
  EXPECT_EQ(fifo->next_ps(), std::nullopt);
  fifo->advance(word_ps(2, 2));
  EXPECT_FALSE(fifo->finishes_next());
  ASSERT_EQ(granted(word_ps(2, 2)), 3);
  leave_at(word_ps(3, 2) - 1, 3);  // the last word comes
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 2));
  EXPECT_FALSE(fifo->finishes_next());
  ASSERT_EQ(granted(word_ps(3, 2)), 1);
  leave_at(word_ps(3, 2) + 10, 1);
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 2) + 10);
  EXPECT_TRUE(fifo->finishes_next());
}

TEST_F(CaptureFifoTest, FinishesWithTheLastDroppedPixel) {
  build({1, 1});
  for (int row = 0; row < 3; ++row) {
    ASSERT_EQ(granted(word_ps(0, row)), 1);
    leave_at(pixel_ps(5, row), 1);
  }
  EXPECT_FALSE(fifo->finished());
  EXPECT_EQ(fifo->next_ps(), pixel_ps(15, 2));
  EXPECT_TRUE(fifo->finishes_next());
  fifo->advance(pixel_ps(15, 2) - 1);
  EXPECT_FALSE(fifo->finished());
  fifo->advance(pixel_ps(15, 2));
  EXPECT_TRUE(fifo->finished());
  EXPECT_EQ(fifo->dropped_pixels(), 36U);
}

TEST_F(CaptureFifoTest, StartsAFrameAnew) {
  build({2, 1});
  for (int row = 0; row < 3; ++row) {
    ASSERT_EQ(granted(word_ps(1, row)), 2);
    leave_at(pixel_ps(15, row), 2);
  }
  ASSERT_TRUE(fifo->finished());
  const std::uint64_t begin = kBegin + timing.frame_ps(1);
  fifo->begin_frame(timing, begin);
  fifo->advance(begin);
  EXPECT_FALSE(fifo->finished());
  EXPECT_EQ(fifo->next_ps(), begin + timing.pixel_ps(3, 0));
  EXPECT_EQ(granted(begin + timing.pixel_ps(3, 0)), 1);
  EXPECT_EQ(burst.at(0).row, 0);
  EXPECT_EQ(fifo->dropped_pixels(), 24U);  // of both frames
}

TEST(CaptureFifo, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(CaptureFifo(CaptureBoardConfig{4, 5}), std::invalid_argument);
  EXPECT_THROW(CaptureFifo(CaptureBoardConfig{0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
