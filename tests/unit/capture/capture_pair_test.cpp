// The two boards of a pair: both take a frame, or neither does.
#include <memory>

#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

// The parameter says whether the left side is built, and so called, before the right side.
class CapturePair : public testing::TestWithParam<bool> {
 protected:
  void build(double right_rate_hz = 29.97) {
    const CameraConfig left_camera{16, 3, 29.97, CameraTrigger::kFreeRunning};
    const CameraConfig right_camera{16, 3, right_rate_hz, CameraTrigger::kFreeRunning};
    const CaptureBoardConfig board{8, 2};
    if (GetParam()) left = std::make_unique<CaptureSide>("left_", left_camera, board, 33.333);
    right = std::make_unique<CaptureSide>("right_", right_camera, board, 33.333);
    if (!left) left = std::make_unique<CaptureSide>("left_", left_camera, board, 33.333);
    left->board.partner.bind(right->board.as_partner);
    right->board.partner.bind(left->board.as_partner);
  }
  std::uint64_t frame_ps(std::uint64_t number) const { return left->camera.timing().frame_ps(number); }
  void expect_started(std::uint64_t frames) const {
    EXPECT_EQ(left->board.stats().started_frames, frames);
    EXPECT_EQ(right->board.stats().started_frames, frames);
  }

  std::unique_ptr<CaptureSide> left;
  std::unique_ptr<CaptureSide> right;
};

TEST_P(CapturePair, DropsFramesThatDoNotBeginTogether) {
  build(29.96);
  left->arm(kAddress);
  right->arm(kAddress);
  run_to(2);
  expect_started(1);  // frame 0
  run_to(frame_ps(1) - 1);
  left->arm(kAddress);
  right->arm(kAddress);
  run_to(frame_ps(4) - 1);
  expect_started(1);
  EXPECT_EQ(left->board.stats().dropped_by_partner, 3U);
}

TEST_P(CapturePair, DecidesTheSameWhicheverSideAsksFirst) {
  build();
  run_to(0);  // frame 0 has begun and is not yet decided
  left->arm(kAddress);
  right->arm(kAddress);
  CapturePartnerIf& first =
      GetParam() ? *left->board.as_partner.operator->() : *right->board.as_partner.operator->();
  EXPECT_TRUE(first.can_start(0, 0));
  EXPECT_FALSE(first.can_start(1, 0));
  EXPECT_FALSE(first.can_start(0, 1));
  run_to(1);
  expect_started(1);
  EXPECT_TRUE(left->board.as_partner->can_start(0, 0));  // the answer stays the same
  EXPECT_TRUE(right->board.as_partner->can_start(0, 0));
}

INSTANTIATE_TEST_SUITE_P(Order, CapturePair, testing::Bool(),
                         [](const auto& order) { return order.param ? "LeftFirst" : "RightFirst"; });

}  // namespace
}  // namespace stereotlm::capture
