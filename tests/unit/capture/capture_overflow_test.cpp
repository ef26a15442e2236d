// A capture board that is granted the bus too late (contract section 3): cases that the random computers do
// not cover.
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

class CaptureOverflow : public CaptureBench, public testing::WithParamInterface<bool> {};

// The paper's board: a FIFO of 140 words that requests the bus with 32. The first burst begins at once, but
// its first word leaves when pixel 600 arrives.
TEST_F(CaptureOverflow, CountsEachPixelAsItIsDroppedAlsoWhileABurstRuns) {
  camera = CameraConfig{};
  board = CaptureBoardConfig{};
  build_and_arm();
  test::BusTurn turn;
  turn.wait_clocks = edge_at_or_after(pixel_ps(600, 0) + 1) - edge_at_or_after(word_ps(31, 0)) - 3;
  plan(0, turn);
  for (const std::uint64_t column : {559U, 560U, 599U, 639U}) {
    run_to(pixel_ps(static_cast<int>(column), 0));
    EXPECT_EQ(side->board.stats().dropped_pixels, column - 559) << column;
  }
}

// A FIFO of one word, and pixel 4 arrives at the edge of the bus clock at which the only word of the first
// burst leaves, or is lost.
TEST_P(CaptureOverflow, HasRoomForAPixelThatArrivesWhenAWordLeaves) {
  camera = {16, 1, 29.97, CameraTrigger::kFreeRunning};
  board = {1, 1};
  clock_mhz = 1000;
  for (int i = 0; i < 100'000 && CameraTiming(camera).pixel_ps(4, 0) % 1000 != 0; ++i)
    camera.frame_rate_hz = (10'000 + i) / 100.0;
  build_and_arm();
  test::BusTurn turn;  // address clock, data clock
  turn.busy_clocks = pixel_ps(4, 0) / 1000 - 2 - edge_at_or_after(word_ps(0, 0));
  if (GetParam()) {
    turn.limit = 0;
    turn.cut = pci::BurstEnd::kMasterAbort;
  }
  plan(0, turn);
  run_frame();
  EXPECT_EQ(burst(0).end_ps, pixel_ps(4, 0));
  EXPECT_EQ(side->board.stats().dropped_pixels, 0U);
}
INSTANTIATE_TEST_SUITE_P(IsLost, CaptureOverflow, testing::Bool());

}  // namespace
}  // namespace stereotlm::capture
