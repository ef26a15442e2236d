// A capture board that is granted the bus too late (contract section 3). The paper's board: 640 x 480, 29.97
// Hz, a FIFO of 140 words that requests the bus with 32.
#include <algorithm>
#include <string>

#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

class CaptureOverflow : public CaptureBench {
 protected:
  CaptureOverflow() {
    camera = CameraConfig{};
    board = CaptureBoardConfig{};
  }
  // The last clock that ends at or before a time.
  std::uint64_t clock_ending_by(std::uint64_t time_ps) const { return edge_at_or_after(time_ps + 1) - 2; }
};

TEST_F(CaptureOverflow, CountsEachPixelAsItIsDroppedAlsoWhileABurstRuns) {
  build_and_arm();
  test::BusTurn turn;  // the burst begins at once, but its first word leaves when pixel 600 arrives
  turn.wait_clocks = clock_ending_by(pixel_ps(600, 0)) - edge_at_or_after(word_ps(31, 0)) - 1;
  plan(0, turn);
  const auto dropped_by = [](int column) { return static_cast<std::uint64_t>(std::max(column - 559, 0)); };
  EXPECT_EQ(pixel_ps(560, 0) / 100'000, 456U);  // 45.6 us
  for (const int column : {559, 560, 561, 600, 639}) {
    run_to(pixel_ps(column, 0) - 1);
    EXPECT_EQ(side->board.stats().dropped_pixels, dropped_by(column - 1)) << column;
    run_to(pixel_ps(column, 0));
    EXPECT_EQ(side->board.stats().dropped_pixels, dropped_by(column)) << column;
  }
  EXPECT_GT(burst(0).end_ps, pixel_ps(600, 0));
  run_to(pixel_ps(100, 1));
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U);
  run_frame();
  EXPECT_EQ(side->board.stats().dropped_pixels, 80U);
  EXPECT_EQ(side->board.stats().words, 640U * 480 / 4 - 20);
}

// A FIFO of one word, and pixel 4 arrives at an edge of the bus clock. The only word of the first burst
// leaves, or is lost, at that edge or a clock later.
struct LastMoment {
  bool lost;
  std::uint64_t late_clocks;
};

class CaptureOverflowEdge : public CaptureOverflow, public testing::WithParamInterface<LastMoment> {};

TEST_P(CaptureOverflowEdge, HasRoomForAPixelThatArrivesWhenAWordLeavesButNotBefore) {
  camera = {16, 1, 29.97, CameraTrigger::kFreeRunning};
  board = {1, 1};
  clock_mhz = 1000;
  for (int i = 0; i < 100'000 && CameraTiming(camera).pixel_ps(4, 0) % 1000 != 0; ++i)
    camera.frame_rate_hz = (10'000 + i) / 100.0;
  build_and_arm();
  ASSERT_EQ(pixel_ps(4, 0) % 1000, 0U);
  const auto [lost, late_clocks] = GetParam();
  test::BusTurn turn;  // address clock, data clock
  turn.busy_clocks = pixel_ps(4, 0) / 1000 + late_clocks - 2 - edge_at_or_after(word_ps(0, 0));
  if (lost) {
    turn.limit = 0;
    turn.cut = pci::BurstEnd::kMasterAbort;
  }
  plan(0, turn);
  run_frame();
  EXPECT_EQ(burst(0).end_ps, pixel_ps(4, 0) + 1000 * late_clocks);
  EXPECT_EQ(side->board.stats().dropped_pixels, late_clocks == 0 ? 0U : 12U);
  EXPECT_EQ(side->board.stats().lost_words, lost ? 1U : 0U);
}

INSTANTIATE_TEST_SUITE_P(Words, CaptureOverflowEdge,
                         testing::Values(LastMoment{false, 0}, LastMoment{false, 1}, LastMoment{true, 0},
                                         LastMoment{true, 1}),
                         [](const auto& tested) {
                           return std::string(tested.param.lost ? "lost" : "written") +
                                  (tested.param.late_clocks == 0 ? "_in_time" : "_a_clock_late");
                         });

}  // namespace
}  // namespace stereotlm::capture
