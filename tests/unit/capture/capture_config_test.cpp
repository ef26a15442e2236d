#include "models/capture/capture_config.h"

#include <gtest/gtest.h>

namespace stereotlm::capture {
namespace {

using Problems = std::vector<std::string>;

TEST(CaptureConfig, NamesEveryProblem) {
  EXPECT_EQ(problems(CameraConfig{0, 0, std::nan(""), CameraTrigger::kFreeRunning}),
            (Problems{"width = 0: must be 4..8192, a multiple of 4", "height = 0: must be 1..8192",
                      "frame_rate_hz = nan: must be 0.1..1000"}));
  EXPECT_EQ(
      problems(CaptureBoardConfig{0, 1}),
      (Problems{"fifo_words = 0: must be 1..4096", "fifo_trigger_words = 1: must be 1..0 (fifo_words)"}));
  EXPECT_EQ(problems(CaptureBoardConfig{140, 140}), Problems{});
}

}  // namespace
}  // namespace stereotlm::capture
