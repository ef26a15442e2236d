#include "sw/runs/simulation/camera_simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "platform/config/board_yaml.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::simulation {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A frame of the core takes 1.6 of the cameras'.
platform::BoardConfig small_board() {
  return platform::load_board("fpl2003", {"image.width=64", "image.height=48", "matcher.disparities=16",
                                          "cameras.frame_rate_hz=1000", "fpga.clock_mhz=13.4"});
}

class CameraSimulationTest : public testing::Test {
 protected:
  void build(std::uint64_t frames, fpga::Fidelity fidelity = fpga::Fidelity::kCycle) {
    simulation.emplace(board, tables, pairs, frames, binder, fidelity);
  }
  std::vector<runs::Result> run() {
    std::vector<runs::Result> results;
    simulation->run([&] {
      for (runs::Result& result : simulation->take_results()) results.push_back(std::move(result));
    });
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

  test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
  platform::BoardConfig board = small_board();
  platform::Tables tables = platform::identity_tables(board);
  test::NoisePairs pairs{64, 48};
  std::optional<runs::CameraSimulation> simulation;
};

TEST_F(CameraSimulationTest, FinishesTheFramesOfTheCoreToEndEarly) {
  for (const fpga::Fidelity fidelity : {fpga::Fidelity::kTiming, fpga::Fidelity::kCycle}) {
    build(100, fidelity);
    std::uint64_t done = 0;  // when it is to end
    simulation->run([&] {
      if (done != 0 || simulation->frames_done() < 3) return;
      done = simulation->frames_done();
      simulation->end_early();
    });
    const std::uint64_t frames = simulation->frames();
    EXPECT_GE(frames, done);
    EXPECT_LE(frames, done + 2);  // one in the core, one on its way back
    EXPECT_EQ(simulation->frames_done(), frames);
    const platform::Statistics statistics = simulation->statistics();
    EXPECT_EQ(statistics.frames, frames);
    EXPECT_THAT(statistics.failed, IsEmpty());
  }
}

TEST_F(CameraSimulationTest, PassesOnWhatTheSourceThrows) {
  pairs.failing_frame = 6;
  build(100);
  const test::ExpectedReport expected(sc_core::SC_ID_SIMULATION_UNCAUGHT_EXCEPTION_);
  EXPECT_EQ(message_of_running(), "the disk is gone");
}

TEST_F(CameraSimulationTest, PassesOnWhatTheSourceThrowsWithoutTheKernel) {
  pairs.failing_frame = 6;
  build(100, fpga::Fidelity::kFast);
  EXPECT_EQ(message_of_running(), "the disk is gone");
}

TEST_F(CameraSimulationTest, PassesOnWhatThrowsBetween) {
  build(100, fpga::Fidelity::kTiming);
  EXPECT_THROW(simulation->run([] { throw std::domain_error("given up"); }), std::domain_error);
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
