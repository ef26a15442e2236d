#include "models/capture/capture_config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stereotlm::capture {
namespace {

using Problems = std::vector<std::string>;

TEST(CameraConfig, AcceptsItsDefaultsAndTheEndsOfItsRanges) {
  EXPECT_EQ(problems(CameraConfig{}), Problems{});
  EXPECT_EQ(problems(CameraConfig{4, 1, 0.1, CameraTrigger::kFreeRunning}), Problems{});
  EXPECT_EQ(problems(CameraConfig{2048, 2048, 1000, CameraTrigger::kOnDemand}), Problems{});
}

TEST(CameraConfig, RefusesWhatLiesOutside) {
  const Problems low{"width = 0: must be 4..2048, a multiple of 4", "height = 0: must be 1..2048",
                     "frame_rate_hz = 0.09999: must be 0.1..1000"};
  EXPECT_EQ(problems(CameraConfig{0, 0, 0.09999, CameraTrigger::kFreeRunning}), low);
  const Problems high{"width = 2052: must be 4..2048, a multiple of 4", "height = 2049: must be 1..2048",
                      "frame_rate_hz = 1000.5: must be 0.1..1000"};
  EXPECT_EQ(problems(CameraConfig{2052, 2049, 1000.5, CameraTrigger::kFreeRunning}), high);
  EXPECT_EQ(problems(CameraConfig{642, 480, 25, CameraTrigger::kFreeRunning}),
            Problems{"width = 642: must be 4..2048, a multiple of 4"});
  EXPECT_EQ(problems(CameraConfig{640, 480, std::nan(""), CameraTrigger::kFreeRunning}),
            Problems{"frame_rate_hz = nan: must be 0.1..1000"});
  EXPECT_EQ(
      problems(CameraConfig{640, 480, std::numeric_limits<double>::infinity(), CameraTrigger::kFreeRunning}),
      Problems{"frame_rate_hz = inf: must be 0.1..1000"});
}

TEST(CaptureBoardConfig, AcceptsItsDefaultsAndTheEndsOfItsRanges) {
  EXPECT_EQ(problems(CaptureBoardConfig{}), Problems{});
  EXPECT_EQ(problems(CaptureBoardConfig{1, 1}), Problems{});
  EXPECT_EQ(problems(CaptureBoardConfig{4096, 4096}), Problems{});
}

TEST(CaptureBoardConfig, RefusesWhatLiesOutside) {
  EXPECT_EQ(problems(CaptureBoardConfig{4097, 32}), Problems{"fifo_words = 4097: must be 1..4096"});
  EXPECT_EQ(problems(CaptureBoardConfig{140, 0}),
            Problems{"fifo_trigger_words = 0: must be 1..140 (fifo_words)"});
  EXPECT_EQ(problems(CaptureBoardConfig{140, 141}),
            Problems{"fifo_trigger_words = 141: must be 1..140 (fifo_words)"});
  EXPECT_EQ(
      problems(CaptureBoardConfig{0, 1}),
      (Problems{"fifo_words = 0: must be 1..4096", "fifo_trigger_words = 1: must be 1..0 (fifo_words)"}));
}

}  // namespace
}  // namespace stereotlm::capture
