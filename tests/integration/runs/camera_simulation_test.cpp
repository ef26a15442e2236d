#include "sw/runs/simulation/camera_simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/support/expected_report.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::simulation {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A frame of the core takes 1.6 of the cameras'.
platform::BoardConfig small_board(std::vector<std::string> sets = {}) {
  sets.insert(sets.begin(),
              {"image.width=64", "image.height=48", "matcher.disparities=16", "cameras.frame_rate_hz=1000"});
  sets.emplace_back("fpga.clock_mhz=13.4");
  return platform::load_board("fpl2003", sets);
}

class CameraSimulationTest : public testing::Test {
 protected:
  void build(std::uint64_t frames, const platform::BoardConfig& config = small_board()) {
    board = config;
    tables = platform::identity_tables(board);
    simulation.emplace(board, tables, pairs, frames, binder);
  }
  std::vector<runs::Result> run() {
    std::vector<runs::Result> results;
    while (!simulation->finished()) {
      for (runs::Result& result : simulation->advance()) results.push_back(std::move(result));
    }
    return results;
  }
  std::string message_of_running() {
    try {
      run();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  test::MonitoringBinder binder;
  platform::BoardConfig board;
  platform::Tables tables;
  test::NoisePairs pairs{64, 48};
  std::optional<runs::CameraSimulation> simulation;
};

// The cameras write into the buffer that the core does not read, so a capture waits for the next camera
// frame. random_computers_test.cpp compares every figure.
TEST_F(CameraSimulationTest, DeliversTheDisparitiesOfThreePairsInFiveCameraFrames) {
  build(31);
  const std::vector<runs::Result> results = run();
  ASSERT_EQ(results.size(), 31U);
  for (const runs::Result& result : results)
    EXPECT_EQ(result.disparity, test::disparity_of(pairs.pair(result.number), board)) << result.number;
  EXPECT_EQ(simulation->last().number, results.back().number);
  const platform::Statistics statistics = simulation->statistics();
  EXPECT_THAT(statistics.failed, IsEmpty());
  EXPECT_NEAR(statistics.frames_per_second.steady->frames_per_second, 600, 6);
}

TEST_F(CameraSimulationTest, FinishesTheFramesOfTheCoreToEndEarly) {
  build(100);
  while (simulation->frames_done() < 3) simulation->advance();
  const std::uint64_t done = simulation->frames_done();
  simulation->end_early();
  const std::uint64_t frames = simulation->frames();
  EXPECT_GE(frames, done);
  EXPECT_LE(frames, done + 2);  // one in the core, one on its way back
  run();
  EXPECT_EQ(simulation->frames_done(), frames);
  const platform::Statistics statistics = simulation->statistics();
  EXPECT_EQ(statistics.frames, frames);
  EXPECT_THAT(statistics.failed, IsEmpty());
}

// The camera sends 24 lines, as fast as on the paper's board: 640 pixels in 52.15 us. A third party keeps the
// bus for 50 us from the first pixel of a line on: the FIFO of 140 words is full at pixel 560, 45.6 us after
// the first pixel.
TEST_F(CameraSimulationTest, KeepsTheOldPixelsWhereTheFifoWasFull) {
  constexpr int kRow = 10;
  constexpr int kFirstDropped = 560;
  constexpr std::uint64_t kFrame = 4;
  const capture::CameraTiming timing({640, 24, 599.4, capture::CameraTrigger::kFreeRunning});
  const auto line_ps = static_cast<double>(timing.frame_ps(kFrame) + timing.row_ps(kRow));
  EXPECT_NEAR(static_cast<double>(timing.pixel_ps(kFirstDropped, 0)) / 1e6, 45.6, 0.05);
  pairs = test::NoisePairs(640, 24);
  platform::BoardConfig config = platform::load_board(
      "fpl2003", {"image.height=24", "matcher.disparities=16", "cameras.frame_rate_hz=599.4"});
  config.pci.load = platform::PciLoadConfig{1, 1e6, line_ps / 1e6, 50};
  build(6, config);
  const std::vector<runs::Result> results = run();
  const kernels::GrayImage black(640, 24);
  std::vector<host::StereoPair> buffers(2, {black, black});
  std::uint64_t hit = 0;
  for (std::size_t frame = 0; frame < results.size(); ++frame) {
    host::StereoPair captured = pairs.pair(results[frame].number);
    host::StereoPair& buffer = buffers[frame % 2];
    if (results[frame].number == kFrame) {
      ++hit;
      ASSERT_GE(frame, 2U);  // an earlier picture is in the buffer
      for (int column = kFirstDropped; column < 640; ++column) {
        captured.left.at(column, kRow) = buffer.left.at(column, kRow);
        captured.right.at(column, kRow) = buffer.right.at(column, kRow);
      }
    }
    buffer = captured;
    EXPECT_EQ(results[frame].disparity, test::disparity_of(captured, board)) << frame;
  }
  EXPECT_EQ(hit, 1U);
  const platform::Statistics statistics = simulation->statistics();
  EXPECT_THAT(statistics.failed, IsEmpty());
  for (const platform::CameraStatistics& camera : statistics.computer->cameras)
    EXPECT_EQ(camera.dropped_pixels, 640U - kFirstDropped);
}

TEST_F(CameraSimulationTest, PassesOnWhatTheSourceThrows) {
  pairs.failing_frame = 6;
  build(100);
  const test::ExpectedReport expected(sc_core::SC_ID_SIMULATION_UNCAUGHT_EXCEPTION_);
  EXPECT_EQ(message_of_running(), "the disk is gone");
}

TEST_F(CameraSimulationTest, ReportsWhoWaitsForWhatWhenNothingProceeds) {
  // A camera whose error is not thrown sends no lines: its capture never ends.
  sc_core::sc_report_handler::set_actions("/stereotlm/camera", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/camera");
  pairs.set_right_size(64, 44);
  build(100);
  EXPECT_THAT(
      message_of_running(),
      AllOf(HasSubstr("no progress for 0.10"),
            HasSubstr("s of simulated time; delivered: 0 of 100 frames; the driver waits for: capture 0; the "
                      "core runs no frame")));
}

}  // namespace
}  // namespace stereotlm::simulation
