// A capture board that does not get the bus in time (contract section 3), on the paper's board: 640 x 480,
// 29.97 Hz, a FIFO of 140 words that asks with 32.
#include <algorithm>

#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

class CaptureOverflow : public CaptureBench {
 protected:
  CaptureOverflow() {
    camera = CameraConfig{};
    board = CaptureBoardConfig{};
  }
  // Others hold the bus until the first word can leave at the end of a clock.
  void first_word_leaves_in(std::uint64_t clock) { grant_in(0, clock - 1); }
  // The last clock that ends at or before a time.
  std::uint64_t clock_ending_by(std::uint64_t time_ps) const { return edge_at_or_after(time_ps + 1) - 2; }
  std::vector<std::uint8_t> row(const std::vector<std::uint8_t>& pixels, int number) const {
    const auto first = pixels.begin() + std::ptrdiff_t{number} * camera.width;
    return {first, first + camera.width};
  }
};

TEST_F(CaptureOverflow, DropsPixel560WhenTheBusIsTakenFromTheFirstOn) {
  build_and_arm();
  EXPECT_EQ(pixel_ps(560, 0) / 100'000, 456U);  // 45.6 us
  first_word_leaves_in(clock_ending_by(pixel_ps(0, 1)));
  run_to(pixel_ps(560, 0) - 1);
  EXPECT_EQ(side->board.stats().dropped_pixels, 0U);
  run_to(pixel_ps(0, 2) - 1);
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U);
  const auto sent = side->source.picture(0).pixels;
  const auto captured = side->buffer(kAddress, 0);
  auto expected = row(sent, 0);
  std::fill(expected.begin() + 560, expected.end(), std::uint8_t{0});
  EXPECT_EQ(row(captured, 0), expected);
  EXPECT_EQ(side->bus.memory.count(kAddress + 556), 1U);
  EXPECT_EQ(side->bus.memory.count(kAddress + 560), 0U);
  EXPECT_EQ(row(captured, 1), row(sent, 1));
}

TEST_F(CaptureOverflow, DropsNothingIfAWordLeavesByThePixel) {
  build_and_arm();
  first_word_leaves_in(clock_ending_by(pixel_ps(560, 0)));
  run_frame();
  EXPECT_EQ(side->board.stats().dropped_pixels, 0U);
  EXPECT_EQ(side->buffer(kAddress, 0), side->source.picture(0).pixels);
}

TEST_F(CaptureOverflow, DropsTheRestOfTheLineIfItLeavesAClockLater) {
  build_and_arm();
  first_word_leaves_in(clock_ending_by(pixel_ps(560, 0)) + 1);
  run_frame();
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U);
  EXPECT_EQ(side->board.stats().words, 640U * 480 / 4 - 20);
}

TEST_F(CaptureOverflow, KeepsWhatWasInTheBufferWhereItDrops) {
  build_and_arm();
  for (std::uint32_t word = 0; word < 160; ++word) side->bus.memory[kAddress + 4 * word] = 0xA5A5A5A5;
  first_word_leaves_in(clock_ending_by(pixel_ps(0, 1)));
  run_frame();
  auto expected = side->source.picture(0).pixels;
  std::fill(expected.begin() + 560, expected.begin() + 640, std::uint8_t{0xA5});
  EXPECT_EQ(side->buffer(kAddress, 0), expected);
}

TEST_F(CaptureOverflow, DropsWholeLinesWhileTheFifoStaysFull) {
  build_and_arm();
  first_word_leaves_in(clock_ending_by(pixel_ps(2, 3)));  // line 3's first pixel has found it full
  run_frame();
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U + 3 * 640);
  auto expected = side->source.picture(0).pixels;
  std::fill(expected.begin() + 560, expected.begin() + 2560, std::uint8_t{0});
  EXPECT_EQ(side->buffer(kAddress, 0), expected);
  EXPECT_EQ(side->board.stats().captured_frames, 1U);
}

TEST_F(CaptureOverflow, EndsTheCaptureWithTheLastPixelIfItIsDropped) {
  camera = {16, 2, 29.97, CameraTrigger::kFreeRunning};
  board = {1, 1};
  build_and_arm();
  grant_in(4, edge_at_or_after(pixel_ps(5, 1)));  // of the last line's first word
  run_to(pixel_ps(15, 1) - 1);
  EXPECT_EQ(side->board.stats().words, 5U);
  EXPECT_EQ(side->board.stats().dropped_pixels, 11U);
  EXPECT_EQ(side->status(), registers::kStatusCapturing);
  run_to(pixel_ps(15, 1));
  EXPECT_EQ(side->status(), registers::kStatusDone);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->board.last_capture()->end_ps, pixel_ps(15, 1));
}

// Figures may be asked for at any time, not only at the end of a burst or line.
TEST_F(CaptureOverflow, CountsEachPixelAsItIsDroppedAlsoWhileABurstRuns) {
  build_and_arm();
  test::BusTurn turn;  // its burst begins at once, but its first word leaves when pixel 600 arrives
  turn.wait_clocks = clock_ending_by(pixel_ps(600, 0)) - edge_at_or_after(word_ps(31, 0)) - 1;
  plan(0, turn);
  const auto dropped_by = [](int column) { return static_cast<std::uint64_t>(std::max(column - 559, 0)); };
  for (const int column : {559, 560, 561, 600, 639}) {
    run_to(pixel_ps(column, 0) - 1);
    EXPECT_EQ(side->board.stats().dropped_pixels, dropped_by(column - 1)) << column;
    run_to(pixel_ps(column, 0));
    EXPECT_EQ(side->board.stats().dropped_pixels, dropped_by(column)) << column;
  }
  EXPECT_GT(burst(0).end_ps, pixel_ps(600, 0));
  run_frame();
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U);
  EXPECT_EQ(side->board.stats().words, 640U * 480 / 4 - 20);
}

// A FIFO of one word, and pixel 4 arrives at an edge of the bus clock: the word must have left by then.
class CaptureOverflowEdge : public CaptureOverflow {
 protected:
  CaptureOverflowEdge() {
    camera = {16, 1, 29.97, CameraTrigger::kFreeRunning};
    board = {1, 1};
    clock_mhz = 1000;
    for (int i = 0; i < 100'000 && CameraTiming(camera).pixel_ps(4, 0) % 1000 != 0; ++i)
      camera.frame_rate_hz = (10'000 + i) / 100.0;
    build_and_arm();
    EXPECT_EQ(pixel_ps(4, 0) % 1000, 0U);
    edge = pixel_ps(4, 0) / 1000;
  }
  void expect_dropped(std::uint64_t pixels) {
    run_frame();
    EXPECT_EQ(side->board.stats().dropped_pixels, pixels);
  }
  // The only word of the first burst is not taken; the burst ends with a clock.
  void first_word_is_lost_in(std::uint64_t clock) {
    grant_in(0, clock - 1);
    const auto granted = side->bus.plan;
    side->bus.plan = [=](std::size_t request) {
      test::BusTurn turn = granted(request);
      if (request == 0) {
        turn.limit = 0;
        turn.cut = pci::BurstEnd::kMasterAbort;
      }
      return turn;
    };
  }
  std::uint64_t edge = 0;
};

TEST_F(CaptureOverflowEdge, HasRoomForAPixelThatArrivesWhenAWordLeaves) {
  first_word_leaves_in(edge - 1);
  expect_dropped(0);
  EXPECT_EQ(side->bus.left_ps(burst(0), 0), pixel_ps(4, 0));
}

TEST_F(CaptureOverflowEdge, HasNoneForOneThatArrivesAClockEarlier) {
  first_word_leaves_in(edge);
  expect_dropped(12);
}

TEST_F(CaptureOverflowEdge, HasRoomForAPixelThatArrivesWhenAWordIsLost) {
  first_word_is_lost_in(edge - 1);
  expect_dropped(0);
  EXPECT_EQ(burst(0).end_ps, pixel_ps(4, 0));
  EXPECT_EQ(side->board.stats().lost_words, 1U);
}

TEST_F(CaptureOverflowEdge, HasNoneForOneThatArrivesAClockBeforeTheLoss) {
  first_word_is_lost_in(edge);
  expect_dropped(12);
}

}  // namespace
}  // namespace stereotlm::capture
