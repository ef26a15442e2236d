#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "models/testing/expected_report.h"
#include "platform/config/board_yaml.h"
#include "sw/runs/simulation/simulation.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::simulation {
namespace {

class PreloadedSimulationTest : public testing::Test {
 protected:
  void build(std::uint64_t frames = 10, fpga::Fidelity fidelity = fpga::Fidelity::kCycle) {
    simulation = runs::make_simulation(board, tables, pairs, {false, fidelity, frames}, binder);
  }
  std::string message_of_running() {
    try {
      simulation->run([] {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  platform::BoardConfig board = platform::load_board("fpl2003", {"image.width=32", "image.height=24"});
  platform::Tables tables = platform::identity_tables(board);
  test::NoisePairs pairs{32, 24};
  Binder binder;
  std::unique_ptr<runs::Simulation> simulation;
};

TEST_F(PreloadedSimulationTest, AdvancesInSlicesUntilTheLastFrame) {
  build();
  EXPECT_FALSE(simulation->finished());
  EXPECT_EQ(simulation->frames_done(), 0U);
  EXPECT_EQ(simulation->statistics().frames, 0U);
  EXPECT_TRUE(simulation->statistics().failed.empty());

  std::vector<runs::Result> results;
  std::vector<std::uint64_t> done;  // after each slice
  simulation->run([&] {
    for (runs::Result& result : simulation->take_results()) results.push_back(std::move(result));
    done.push_back(simulation->frames_done());
    EXPECT_EQ(results.size(), done.back());
    if (done.size() != 1) return;
    // The seventh frame is under way and is not in the figures.
    const platform::Statistics statistics = simulation->statistics();
    EXPECT_EQ(statistics.frame_cycles, std::vector<std::uint64_t>(6, 5992));
    EXPECT_EQ(statistics.cycles, 6U * (5992 - 16));
    EXPECT_EQ(statistics.banks.at(4).writes + statistics.banks.at(5).writes, 6U * 32 * 24 / 4);
    EXPECT_EQ(statistics.failed, std::vector<std::string>{});
    EXPECT_EQ(simulation->cycles_of_done(), 6U * 5992);
    EXPECT_GE(simulation->cycles(), 40'000U);
    EXPECT_FALSE(simulation->finished());
  });
  // A frame has 5992 cycles, a slice 40,000.
  EXPECT_EQ(done, (std::vector<std::uint64_t>{6, 10}));
  EXPECT_TRUE(simulation->finished());
  ASSERT_EQ(results.size(), 10U);
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    EXPECT_EQ(results[frame].number, frame);
    EXPECT_EQ(results[frame].disparity, test::disparity_of(pairs.pair(frame), board)) << frame;
  }
  EXPECT_EQ(simulation->last().disparity, results.back().disparity);
  EXPECT_EQ(simulation->last().number, 9U);
}

// Notes how far the simulation is when the first cycle of a window is observed.
struct TimeOfWindow : fpga::CycleObserver, platform::BusObserver {
  explicit TimeOfWindow(const runs::Simulation& observed) : simulation(observed) {}
  void cycle(const fpga::CoreCycle& /*cycle*/) override {
    if (!cycles) cycles = simulation.cycles();
  }
  void burst(const platform::BusBurst& /*burst*/) override {}
  void level(const platform::QueueLevel& /*level*/) override {}

  const runs::Simulation& simulation;
  std::optional<std::uint64_t> cycles;
};

// So that an interrupt is heard within a frame. A slice has 2,000,000 cycles, the frame 34 million.
TEST_F(PreloadedSimulationTest, ComputesALongFrameInManySlicesAtFidelityFast) {
  board = platform::load_board("fpl2003", {"image.width=64", "image.height=64", "matcher.window=31",
                                           "matcher.disparities=254", "matcher.units=1"});
  tables = platform::identity_tables(board);
  build(1, fpga::Fidelity::kTiming);
  simulation->record_conflicts();
  TimeOfWindow observer(*simulation);
  simulation->trace({{}, fpga::CycleWindow::Unit::kCycles, 20'000'000, 20'000'000}, observer, observer);
  simulation->run([] {});
  EXPECT_GT(simulation->statistics().frame_cycles.at(0), 30'000'000U);
  ASSERT_TRUE(observer.cycles);
  EXPECT_LE(*observer.cycles, 22'000'000U);
}

TEST_F(PreloadedSimulationTest, AbandonsTheFrameUnderWayToEndEarly) {
  build();
  simulation->run([&] { simulation->end_early(); });
  EXPECT_TRUE(simulation->finished());
  EXPECT_EQ(simulation->frames(), 6U);
  EXPECT_EQ(simulation->statistics().frames, 6U);
}

TEST_F(PreloadedSimulationTest, PassesOnWhatTheSourceThrows) {
  pairs.failing_frame = 3;
  build();
  const test::ExpectedReport expected(sc_core::SC_ID_SIMULATION_UNCAUGHT_EXCEPTION_);
  EXPECT_EQ(message_of_running(), "the disk is gone");
  EXPECT_EQ(simulation->frames_done(), 3U);
}

TEST_F(PreloadedSimulationTest, PassesOnWhatAModelReports) {
  pairs.set_right_size(28, 24);
  build(1);
  const test::ExpectedReport expected("/stereotlm/ideal_host");
  EXPECT_THROW(simulation->run([] {}), sc_core::sc_report);
}

TEST_F(PreloadedSimulationTest, ReportsARunThatStopsBeforeTheLastFrame) {
  build();
  // The error is not thrown, so the host stops.
  sc_core::sc_report_handler::set_actions("/stereotlm/ideal_host", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/ideal_host");
  std::string message;
  try {
    simulation->run([&] {
      ASSERT_EQ(simulation->frames_done(), 6U);
      pairs.set_right_size(28, 24);
    });
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  EXPECT_EQ(message, "the simulation has ended after 7 frames: no event is left that could finish the next");
}

}  // namespace
}  // namespace stereotlm::simulation
