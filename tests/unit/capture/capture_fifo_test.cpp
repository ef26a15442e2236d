// The FIFO by itself. The tests of the capture board check its requests, grants and drops against the bus.
#include "models/capture/capture_fifo.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::capture {
namespace {

constexpr std::uint64_t kBegin = 1'000'000;

// Frames of 16 x 3 pixels, 4 words a line.
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

TEST_F(CaptureFifoTest, RequestsTheBusAtItsTriggerOrAtTheEndOfTheLine) {
  for (int trigger = 1; trigger <= 5; ++trigger) {
    build({8, trigger});
    const std::uint64_t request_ps = word_ps(std::min(trigger, 4) - 1, 0);
    for (const std::uint64_t now : {kBegin, request_ps - 1, request_ps}) {
      fifo->advance(now);
      EXPECT_EQ(fifo->next_ps(), request_ps) << trigger;
    }
  }
}

TEST_F(CaptureFifoTest, RequestsTheBusAgainForOldWordsAtOnceAndForNewWordsAsBefore) {
  struct Case {
    const char* what;
    CaptureBoardConfig config;
    std::uint64_t granted_ps;
    int granted;
    std::uint64_t end_ps;  // of the burst
    int left;              // words that have left by then
    std::optional<std::uint64_t> next_ps;
  };
  const std::uint64_t line_end_ps = word_ps(3, 0);
  const Case cases[] = {
      {"a word was cut", {4, 3}, word_ps(2, 0), 3, pixel_ps(12, 0), 2, pixel_ps(12, 0)},
      {"a retry", {4, 3}, word_ps(2, 0), 3, pixel_ps(12, 0), 0, pixel_ps(12, 0)},
      {"the trigger is to come", {8, 2}, word_ps(0, 0), 1, word_ps(1, 0), 1, word_ps(2, 0)},
      {"the end of the line is to come", {8, 3}, word_ps(1, 0), 2, word_ps(2, 0), 2, line_end_ps},
      {"the trigger was reached meanwhile", {8, 2}, word_ps(0, 0), 1, word_ps(2, 0), 1, word_ps(2, 0)},
      {"a line ended meanwhile", {8, 2}, word_ps(2, 0), 3, line_end_ps + 10, 3, line_end_ps + 10},
      {"empty between lines", {8, 2}, line_end_ps, 4, line_end_ps + 10, 4, std::nullopt},
      {"the rest of the line is dropped", {2, 2}, word_ps(1, 0), 2, pixel_ps(9, 0), 2, std::nullopt},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    build(c.config);
    ASSERT_EQ(granted(c.granted_ps), c.granted);
    leave_at(c.end_ps, c.left);
    EXPECT_EQ(fifo->next_ps(), c.next_ps);
  }
}

// A word leaves as each new word begins: the FIFO of two words stays full and drops nothing, unless the second
// one leaves 1 ps too late.
TEST_F(CaptureFifoTest, FollowsTheWordsOfABurstOneByOne) {
  for (const std::uint64_t late_ps : {0U, 1U}) {
    build({2, 1});
    ASSERT_EQ(granted(word_ps(1, 0)), 2);
    fifo->leave(pixel_ps(12, 0) + late_ps, 2, [&](std::uint64_t now) {
      return (now >= pixel_ps(8, 0) ? 1 : 0) + (now >= pixel_ps(12, 0) + late_ps ? 1 : 0);
    });
    EXPECT_EQ(fifo->dropped_pixels(), late_ps);
  }
}

TEST_F(CaptureFifoTest, DropsTheRestOfALineThoughWordsLeave) {
  build({2, 1});
  ASSERT_EQ(granted(word_ps(0, 0)), 1);
  leave_at(pixel_ps(8, 0) + 1, 1);
  EXPECT_EQ(granted(pixel_ps(0, 1) - 1), 1);
  EXPECT_EQ(burst.at(0).first, 1);
  EXPECT_EQ(fifo->dropped_pixels(), 8U);
}

TEST_F(CaptureFifoTest, EndsABurstWhereTheAddressesAreNotContiguous) {
  build({3, 1});
  ASSERT_EQ(granted(word_ps(2, 0)), 3);
  leave_at(pixel_ps(0, 1), 1);  // too late for word 3 of line 0
  EXPECT_EQ(fifo->dropped_pixels(), 4U);
  EXPECT_EQ(granted(word_ps(0, 1)), 2);  // words of line 0, without word 0 of line 1
  leave_at(word_ps(0, 1), 2);
  EXPECT_EQ(fifo->next_ps(), word_ps(0, 1));  // that word was in the FIFO at the grant
  EXPECT_EQ(granted(word_ps(0, 1)), 1);
  EXPECT_EQ(burst.at(0).row, 1);
}

TEST_F(CaptureFifoTest, FinishesWithTheLastWordOrTheLastDroppedPixel) {
  build({4, 4});
  for (int row = 0; row < 2; ++row) {
    ASSERT_EQ(granted(word_ps(3, row)), 4);
    leave_at(word_ps(3, row) + 10, 4);
  }
  fifo->advance(word_ps(2, 2));
  EXPECT_FALSE(fifo->finishes_next());
  ASSERT_EQ(granted(word_ps(2, 2)), 3);
  leave_at(word_ps(3, 2) - 1, 3);  // the last word is still to come
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 2));
  EXPECT_FALSE(fifo->finishes_next());
  ASSERT_EQ(granted(word_ps(3, 2)), 1);
  EXPECT_FALSE(fifo->finished());
  leave_at(word_ps(3, 2) + 10, 1);
  EXPECT_EQ(fifo->next_ps(), word_ps(3, 2) + 10);
  EXPECT_TRUE(fifo->finishes_next());
  EXPECT_TRUE(fifo->finished());

  build({1, 1});
  for (int row = 0; row < 3; ++row) {
    ASSERT_EQ(granted(word_ps(0, row)), 1);
    leave_at(pixel_ps(5, row), 1);
  }
  EXPECT_EQ(fifo->next_ps(), pixel_ps(15, 2));
  EXPECT_TRUE(fifo->finishes_next());
  fifo->advance(pixel_ps(15, 2) - 1);
  EXPECT_FALSE(fifo->finished());
  fifo->advance(pixel_ps(15, 2));
  EXPECT_TRUE(fifo->finished());
  EXPECT_EQ(fifo->dropped_pixels(), 36U);
}

TEST(CaptureFifo, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(CaptureFifo(CaptureBoardConfig{4, 5}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
