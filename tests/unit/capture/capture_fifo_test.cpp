// What CaptureFifo tells to skip lines. The tests of the board cover its requests and its words.
#include "models/capture/capture_fifo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace stereotlm::capture {
namespace {

// Pictures of 8 x 4 pixels: two words in a line.
class CaptureFifoTest : public testing::Test {
 protected:
  static constexpr std::uint64_t kBeginPs = 1'000'003;
  static constexpr int kWidth = 8;

  // The arrival of a pixel. Column 8 is the first one of the next row.
  std::uint64_t arrival_ps(int column, int row) const {
    return kBeginPs + timing.pixel_ps(column % kWidth, row + column / kWidth);
  }
  // The words of the next line leave one by one.
  std::uint64_t step_line(CaptureFifo& fifo) const {
    std::uint64_t now_ps = 0;
    for (int words = 0; words < fifo.words_per_line();) {
      now_ps = fifo.next_ps();
      fifo.advance(now_ps);
      const int granted = fifo.grant().count;
      now_ps += 50;
      fifo.lose(now_ps, granted);
      words += granted;
    }
    return now_ps;
  }

  CameraTiming timing{{kWidth, 4, 30, CameraTrigger::kFreeRunning}};
  CaptureBoardConfig config{4, 1};
};

TEST_F(CaptureFifoTest, HasTheSameWordsFromAFirstOrLastPixelOfAWordToTheNext) {
  CaptureFifo fifo(config);
  fifo.begin_frame(timing, kBeginPs);
  struct Case {
    int pixels;  // that have arrived
    int first;   // columns
    int end;
  };
  constexpr Case kCases[] = {{1, 0, 3}, {2, 0, 3}, {3, 0, 3}, {4, 3, 4},
                             {5, 4, 7}, {6, 4, 7}, {7, 4, 7}, {8, 7, 8}};
  for (const auto& [pixels, first, end] : kCases) {
    for (const std::uint64_t time_ps : {arrival_ps(pixels - 1, 1), arrival_ps(pixels, 1) - 1}) {
      const CaptureFifo::Span span = fifo.same_words(1, time_ps);
      EXPECT_EQ(span.first_ps, arrival_ps(first, 1)) << pixels;
      EXPECT_EQ(span.end_ps, arrival_ps(end, 1)) << pixels;
    }
  }
}

TEST_F(CaptureFifoTest, IsInTheSameStateAfterALineThatIsSkipped) {
  CaptureFifo stepped(config);
  CaptureFifo skipping(config);
  for (CaptureFifo* fifo : {&stepped, &skipping}) {
    fifo->begin_frame(timing, kBeginPs);
    step_line(*fifo);
  }
  const std::uint64_t checks = stepped.full_checks();
  ASSERT_EQ(skipping.next_row(), 1);
  skipping.skip_line(step_line(stepped));
  EXPECT_EQ(stepped.full_checks(), checks);
  for (int row = 2; row < 4; ++row) {
    EXPECT_TRUE(stepped.is_between_lines());
    EXPECT_TRUE(skipping.is_between_lines());
    EXPECT_EQ(skipping.next_row(), row);
    EXPECT_EQ(skipping.next_ps(), stepped.next_ps());
    EXPECT_EQ(skipping.next_ps(), skipping.first_request_ps(row));
    EXPECT_EQ(step_line(skipping), step_line(stepped));
  }
  EXPECT_TRUE(stepped.finishes_next());
  EXPECT_TRUE(skipping.finishes_next());
  EXPECT_FALSE(skipping.has_row(4));
  EXPECT_TRUE(skipping.has_row(3));
}

class CountedWords : public FifoObserver {
 public:
  void word_came(std::uint64_t time_ps) override {
    came += time_ps > last_ps ? 1 : 0;
    last_ps = std::max(last_ps, time_ps);
  }
  void words_left(std::uint64_t /*time_ps*/, std::size_t words) override { left += words; }
  std::uint64_t last_ps = 0;
  std::size_t came = 0;
  std::size_t left = 0;
};

// Its observer has received the first word of the line when the line is skipped.
TEST_F(CaptureFifoTest, ReportsAsManyWordsThatComeAsLeaveInALineThatIsSkipped) {
  CaptureFifo fifo(config);
  CountedWords words;
  fifo.observe(words);
  fifo.begin_frame(timing, kBeginPs);
  const std::uint64_t end_ps = step_line(fifo);
  CaptureFifo shown = fifo;
  shown.advance(arrival_ps(3, 1));
  EXPECT_EQ(words.came, 3);
  EXPECT_EQ(words.left, 2);
  fifo.skip_line(end_ps + arrival_ps(0, 1) - arrival_ps(0, 0));
  EXPECT_EQ(words.came, 4);
  EXPECT_EQ(words.left, 4);
}

// With two places, the second word of a line needs no check and the third one does.
TEST_F(CaptureFifoTest, CountsTheChecksForAFreePlace) {
  const CameraTiming wide({12, 1, 30, CameraTrigger::kFreeRunning});
  CaptureFifo fifo(CaptureBoardConfig{2, 1});
  fifo.begin_frame(wide, 0);
  fifo.advance(wide.pixel_ps(8, 0) - 1);
  EXPECT_EQ(fifo.full_checks(), 0U);
  fifo.advance(wide.pixel_ps(8, 0));
  EXPECT_EQ(fifo.full_checks(), 1U);
}

}  // namespace
}  // namespace stereotlm::capture
