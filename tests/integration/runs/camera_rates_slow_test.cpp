// The frame rate of cameras, buffers and core together. Every result is compared with the disparities of the
// captured pictures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::simulation {
namespace {

struct RateCase {
  std::string name;
  std::string board;
  std::vector<std::string> sets;
  std::optional<double> pairs_a_camera_frame;  // nullopt: as fast as the core
};
void PrintTo(const RateCase& rate, std::ostream* out) { *out << rate.name; }
std::string name_of(const testing::TestParamInfo<RateCase>& info) { return info.param.name; }

class CameraRates : public testing::TestWithParam<RateCase> {};

TEST_P(CameraRates, AreThoseOfTheSlowestPartOverSixtyFrames) {
  const platform::BoardConfig board = platform::load_board(GetParam().board, GetParam().sets);
  const platform::Tables tables = platform::identity_tables(board);
  test::NoisePairs pairs(board.image.width, board.image.height, 9);
  test::NoisePairs expected_pairs = pairs;  // can be read while a capture is under way
  Binder binder;
  runs::CameraSimulation simulation(board, tables, pairs, 61, binder);
  while (!simulation.finished()) {
    for (const runs::Result& result : simulation.advance()) {
      const host::StereoPair& pair = expected_pairs.pair(result.number);
      EXPECT_EQ(result.disparity, test::disparity_of(pair, board)) << result.number;
    }
  }
  const platform::Statistics statistics = simulation.statistics();
  EXPECT_THAT(statistics.failed, testing::IsEmpty());
  const auto& pairs_a_camera_frame = GetParam().pairs_a_camera_frame;
  const double expected = pairs_a_camera_frame ? *pairs_a_camera_frame * board.cameras.frame_rate_hz
                                               : statistics.frames_per_second.core;
  EXPECT_NEAR(statistics.frames_per_second.steady->frames_per_second / expected, 1, 0.01);
}

// A sixteenth of the pixels from cameras that are sixteen times as fast: the core needs nearly the same part
// of a camera frame, 1.17 with a window of 5, 1.62 with 7, 2.08 with 9.
std::vector<std::string> sixteenth(std::vector<std::string> sets) {
  sets.insert(sets.end(), {"image.width=160", "image.height=120", "cameras.frame_rate_hz=479.52"});
  return sets;
}
const std::string kFive = "matcher.window=5";
const std::string kNine = "matcher.window=9";
const std::string kToHost = "capture.destination=host_memory";

INSTANTIATE_TEST_SUITE_P(
    Sixteenth, CameraRates,
    testing::Values(RateCase{"TwoBuffersWindow5", "fpl2003", sixteenth({kFive}), 2.0 / 3},
                    RateCase{"TwoBuffersWindow7", "fpl2003", sixteenth({}), 3.0 / 5},
                    RateCase{"TwoBuffersWindow9", "fpl2003", sixteenth({kNine}), std::nullopt},
                    RateCase{"OneBufferWindow7", "fpl2003",
                             sixteenth({"allocation.left_image=bank0", "allocation.right_image=bank2"}),
                             1.0 / 3},
                    RateCase{"ThreeBuffersWindow5", "fpl2003-triple", sixteenth({kFive}), std::nullopt},
                    RateCase{"ThreeBuffersWindow7", "fpl2003-triple", sixteenth({}), std::nullopt},
                    RateCase{"HostMemoryWindow5", "fpl2003", sixteenth({kToHost, kFive}), std::nullopt},
                    RateCase{"HostMemoryWindow7", "fpl2003", sixteenth({kToHost}), std::nullopt},
                    RateCase{"HostMemoryWindow9", "fpl2003", sixteenth({kToHost, kNine}), std::nullopt}),
    name_of);
INSTANTIATE_TEST_SUITE_P(Paper, CameraRates,
                         testing::Values(RateCase{"TwoBuffersWindow7", "fpl2003", {}, 3.0 / 5}), name_of);

}  // namespace
}  // namespace stereotlm::simulation
