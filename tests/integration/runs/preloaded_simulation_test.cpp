#include "sw/runs/simulation/preloaded_simulation.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/kernels/stereo.h"
#include "platform/config/board_yaml.h"
#include "tests/support/expected_report.h"

namespace stereotlm::simulation {
namespace {

platform::BoardConfig small_board() {
  return platform::load_board("fpl2003", {"image.width=32", "image.height=24"});
}

// The same pair for every frame, of which the right picture may be changed.
class OnePair : public host::FrameSource {
 public:
  const host::StereoPair& pair(std::uint64_t /*frame*/) override { return pair_; }
  host::StereoPair pair_ = {kernels::GrayImage(32, 24), kernels::GrayImage(32, 24)};
};

// Frame f shows noise of its own, and is as the kernels say.
class Noise : public host::FrameSource {
 public:
  const host::StereoPair& pair(std::uint64_t frame) override {
    if (frame == failing_frame) throw std::runtime_error("the disk is gone");
    std::mt19937 random(static_cast<std::uint32_t>(frame));
    for (auto* image : {&pair_.left, &pair_.right}) {
      for (auto& pixel : image->pixels) pixel = static_cast<std::uint8_t>(random());
    }
    return pair_;
  }
  kernels::GrayImage disparity(std::uint64_t frame) {
    const host::StereoPair& shown = pair(frame);
    return kernels::disparity_image(shown.left, shown.right, nullptr, nullptr, {});
  }
  std::optional<std::uint64_t> failing_frame;

 private:
  host::StereoPair pair_ = {kernels::GrayImage(32, 24), kernels::GrayImage(32, 24)};
};

std::string message_of_advancing(runs::Simulation& simulation) {
  try {
    simulation.advance();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PreloadedSimulation, AdvancesInSlicesUntilTheLastFrame) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  OnePair pairs;
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 10, binder);
  EXPECT_FALSE(simulation.finished());
  EXPECT_EQ(simulation.frames_done(), 0U);
  EXPECT_EQ(simulation.statistics().frames, 0U);
  EXPECT_TRUE(simulation.statistics().failed.empty());

  simulation.advance();
  // A frame has 5992 cycles, a slice 40,000.
  EXPECT_EQ(simulation.frames_done(), 6U);
  // The seventh is under way and leaves no trace in the figures.
  const platform::Statistics statistics = simulation.statistics();
  EXPECT_EQ(statistics.frame_cycles, std::vector<std::uint64_t>(6, 5992));
  EXPECT_EQ(statistics.cycles, 6U * (5992 - 16));
  EXPECT_EQ(statistics.banks.at(4).writes + statistics.banks.at(5).writes, 6U * 32 * 24 / 4);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
  EXPECT_EQ(simulation.cycles_of_done(), 6U * 5992);
  EXPECT_GE(simulation.cycles(), 40'000U);
  EXPECT_FALSE(simulation.finished());

  simulation.advance();
  EXPECT_TRUE(simulation.finished());
  EXPECT_EQ(simulation.frames_done(), 10U);
  EXPECT_EQ(simulation.last().disparity.width, 32);
  EXPECT_EQ(simulation.last().number, 9U);
}

TEST(PreloadedSimulation, ReturnsTheDisparitiesOfEachFrameOnceInOrder) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  Noise pairs;
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 10, binder);
  std::vector<runs::Result> ended = simulation.advance();
  EXPECT_EQ(ended.size(), 6U);
  for (runs::Result& result : simulation.advance()) ended.push_back(std::move(result));
  ASSERT_EQ(ended.size(), 10U);
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    EXPECT_EQ(ended[frame].number, frame);
    EXPECT_EQ(ended[frame].disparity, pairs.disparity(frame)) << frame;
  }
  EXPECT_EQ(simulation.last().disparity, ended.back().disparity);
}

TEST(PreloadedSimulation, GivesUpTheFrameUnderWayToEndEarly) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  OnePair pairs;
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 10, binder);
  simulation.advance();
  simulation.end_early();
  EXPECT_TRUE(simulation.finished());
  EXPECT_EQ(simulation.frames(), 6U);
  EXPECT_EQ(simulation.statistics().frames, 6U);
}

TEST(PreloadedSimulation, PassesOnWhatTheSourceThrows) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  Noise pairs;
  pairs.failing_frame = 3;
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 10, binder);
  const test::ExpectedReport expected(sc_core::SC_ID_SIMULATION_UNCAUGHT_EXCEPTION_);
  EXPECT_EQ(message_of_advancing(simulation), "the disk is gone");
  EXPECT_EQ(simulation.frames_done(), 3U);
}

TEST(PreloadedSimulation, PassesOnWhatAModelReports) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  OnePair pairs;
  pairs.pair_.right = kernels::GrayImage(28, 24);
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 1, binder);
  const test::ExpectedReport expected("/stereotlm/ideal_host");
  EXPECT_THROW(simulation.advance(), sc_core::sc_report);
}

TEST(PreloadedSimulation, SaysThatItHasEndedBeforeTheLastFrame) {
  const platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  OnePair pairs;
  Binder binder;
  runs::PreloadedSimulation simulation(board, tables, pairs, 10, binder);
  simulation.advance();
  ASSERT_EQ(simulation.frames_done(), 6U);
  // An error that is not thrown: the host does no more.
  sc_core::sc_report_handler::set_actions("/stereotlm/ideal_host", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/ideal_host");
  pairs.pair_.right = kernels::GrayImage(28, 24);
  EXPECT_EQ(message_of_advancing(simulation),
            "the simulation has ended after 7 frames: nothing is left that could finish the next");
}

TEST(PreloadedSimulation, CannotBeBuiltOfAWrongBoard) {
  platform::BoardConfig board = small_board();
  const platform::Tables tables = platform::identity_tables(board);
  OnePair pairs;
  board.matcher.window = 4;
  Binder binder;
  EXPECT_THROW(runs::PreloadedSimulation(board, tables, pairs, 1, binder), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::simulation
