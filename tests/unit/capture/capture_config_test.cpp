#include "models/capture/capture_config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stereotlm::capture {
namespace {

using Problems = std::vector<std::string>;

TEST(CameraConfig, NamesEveryProblem) {
  constexpr auto kFree = CameraTrigger::kFreeRunning;
  const std::pair<CameraConfig, Problems> cases[] = {
      {{}, {}},
      {{4, 1, 0.1, kFree}, {}},
      {{8192, 8192, 1000, CameraTrigger::kOnDemand}, {}},
      {{0, 0, 0.09999, kFree},
       {"width = 0: must be 4..8192, a multiple of 4", "height = 0: must be 1..8192",
        "frame_rate_hz = 0.09999: must be 0.1..1000"}},
      {{8196, 8193, 1000.5, kFree},
       {"width = 8196: must be 4..8192, a multiple of 4", "height = 8193: must be 1..8192",
        "frame_rate_hz = 1000.5: must be 0.1..1000"}},
      {{642, 480, 25, kFree}, {"width = 642: must be 4..8192, a multiple of 4"}},
      {{640, 480, std::nan(""), kFree}, {"frame_rate_hz = nan: must be 0.1..1000"}},
      {{640, 480, std::numeric_limits<double>::infinity(), kFree},
       {"frame_rate_hz = inf: must be 0.1..1000"}},
  };
  for (const auto& [config, expected] : cases) EXPECT_EQ(problems(config), expected);
}

TEST(CaptureBoardConfig, NamesEveryProblem) {
  const std::pair<CaptureBoardConfig, Problems> cases[] = {
      {{}, {}},
      {{1, 1}, {}},
      {{4096, 4096}, {}},
      {{4097, 32}, {"fifo_words = 4097: must be 1..4096"}},
      {{140, 0}, {"fifo_trigger_words = 0: must be 1..140 (fifo_words)"}},
      {{140, 141}, {"fifo_trigger_words = 141: must be 1..140 (fifo_words)"}},
      {{0, 1}, {"fifo_words = 0: must be 1..4096", "fifo_trigger_words = 1: must be 1..0 (fifo_words)"}},
  };
  for (const auto& [config, expected] : cases) EXPECT_EQ(problems(config), expected);
}

}  // namespace
}  // namespace stereotlm::capture
