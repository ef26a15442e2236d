// Whole computers around random boards, each in a process of its own under the monitor: identities and bounds hold, and
// results are those of the pictures that were captured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "models/kernels/stereo.h"
#include "platform/board_yaml.h"
#include "sw/simulation/camera_simulation.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/noise_picture.h"
#include "tests/support/random_board.h"

namespace stereotlm::simulation {
namespace {

using kernels::RectificationTable;
using platform::BoardConfig;
using test::SplitMix64;

class Noise : public host::FrameSource {
 public:
  explicit Noise(const BoardConfig& board) : width_(board.image.width), height_(board.image.height) {}
  const host::StereoPair& pair(std::uint64_t number) override {
    pair_ = {test::noise_picture(width_, height_, number), test::noise_picture(width_, height_, number, 3)};
    return pair_;
  }

 private:
  int width_;
  int height_;
  host::StereoPair pair_;
};

template <typename Value>
Value one_of(SplitMix64& random, const std::vector<Value>& values) {
  return values[static_cast<std::size_t>(random.between(0, static_cast<int>(values.size()) - 1))];
}

// Everything around the board; clocks of the core and the buses in any proportion.
void surround(BoardConfig& board, SplitMix64& random) {
  board.cameras.frame_rate_hz = one_of<double>(random, {1000, 1000, 500, 299.7});
  board.cameras.trigger =
      random.chance(25) ? platform::CameraTrigger::kOnDemand : platform::CameraTrigger::kFreeRunning;
  board.capture.destination =
      random.chance(40) ? platform::CaptureDestination::kHostMemory : platform::CaptureDestination::kBoard;
  board.capture.host_frames = random.between(1, 4);
  board.capture.fifo_words = one_of<int>(random, {1, 2, 16, 140, 4096});
  board.capture.fifo_trigger_words = random.between(1, std::min(board.capture.fifo_words, 32));
  board.pci.clock_mhz = one_of<double>(random, {33.333, 33.333, 66, 10, 133.7});
  board.pci.latency_timer_clocks = one_of<int>(random, {0, 1, 16, 64, 255});
  board.pci.bridge_wait_clocks = one_of<int>(random, {0, 4, 4, 40});
  board.pci.memory_wait_clocks = one_of<int>(random, {0, 8, 8, 40});
  board.bridge.local_clock_mhz = one_of<double>(random, {40, 40, 10, 66.6, 160});
  board.bridge.dma_burst_words = one_of<int>(random, {1, 2, 7, 32, 1024});
  board.bridge.posted_words = one_of<int>(random, {1, 5, 64, 4096});
  board.fpga.clock_mhz = one_of<double>(random, {40, 40, 12.5, 100});
  if (!random.chance(30)) return;
  board.pci.load =
      platform::PciLoadConfig{one_of<int>(random, {1, 32, 500}), one_of<double>(random, {0, 5, 100}),
                              one_of<double>(random, {0, 777.7}), one_of<double>(random, {0, 0, 1, 60})};
}

const RectificationTable* pointer(const std::optional<RectificationTable>& table) {
  return table ? &*table : nullptr;
}

// What is wrong with a run of this board.
std::string run(const BoardConfig& board, const platform::Tables& tables, std::uint64_t frames) {
  Noise pairs(board);
  test::MonitoringBinder binder;
  CameraSimulation simulation(board, tables, pairs, frames, binder);
  std::vector<Result> results;
  while (!simulation.finished()) {
    for (Result& result : simulation.advance()) results.push_back(std::move(result));
  }
  const platform::Statistics statistics = simulation.statistics();
  std::string text;
  for (const std::string& failed : statistics.failed) text += failed + '\n';
  for (const platform::CameraStatistics& camera : statistics.computer->cameras) {
    if (camera.dropped_pixels > 0) return text;  // the pictures are not those of the cameras
    if (board.cameras.trigger == platform::CameraTrigger::kOnDemand && camera.dropped_frames > 0)
      text += "a camera on demand has dropped a frame\n";
  }
  const kernels::StereoConfig config{board.matcher.window, board.matcher.disparities, board.matcher.filter,
                                     board.matcher.lr_tolerance};
  for (const Result& result : results) {
    const host::StereoPair& pair = pairs.pair(result.number);
    if (result.disparity !=
        kernels::disparity_image(pair.left, pair.right, pointer(tables.left), pointer(tables.right), config))
      text += "camera frame " + std::to_string(result.number) + ": wrong disparities\n";
  }
  return text;
}

std::string run_random(std::uint64_t seed) {
  const test::RandomBoard random_board = test::make_random_board(seed);
  BoardConfig board = test::board_config(random_board);
  SplitMix64 random(seed + 1'000'000);
  surround(board, random);
  const std::string wrong =
      run(board, test::board_tables(random_board), static_cast<std::uint64_t>(random.between(1, 6)));
  return wrong.empty() ? wrong : wrong + platform::to_yaml(board);
}

TEST(RandomComputers, KeepTheirIdentitiesAndBoundsAndComputeWhatTheyCaptured) {
  const char* text = std::getenv("STEREOTLM_RANDOM_COMPUTERS");
  const std::uint64_t count = text != nullptr ? std::stoull(text) : 100;
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < count; ++seed) jobs.push_back([seed] { return run_random(seed); });
  const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const std::vector<test::ChildResult> results = test::run_in_children(jobs, processors);
  for (std::size_t seed = 0; seed < results.size(); ++seed)
    EXPECT_TRUE(results[seed].ok()) << "seed " << seed << ":\n" << results[seed].text;
}

// Four local clocks a cycle and one word a burst: what lies between two words costs nothing.
TEST(SaturatedLocalBus, StaysBelowItsBound) {
  const BoardConfig board = platform::load_board(
      "fpl2003-no-calibration",
      {"image.width=32", "image.height=28", "matcher.disparities=1", "matcher.window=3",
       "matcher.filter=none", "matcher.fetch=line_buffer", "cameras.frame_rate_hz=1000", "pci.clock_mhz=1000",
       "pci.bridge_wait_clocks=0", "pci.memory_wait_clocks=0", "bridge.local_clock_mhz=4",
       "bridge.dma_burst_words=1", "bridge.posted_words=4096", "fpga.clock_mhz=1",
       "fpga.pipeline_latency_cycles=0", "ssram.default={words: 524288, kind: zbt_flow_through}"});
  EXPECT_EQ(run(board, platform::identity_tables(board), 30), "");
}

}  // namespace
}  // namespace stereotlm::simulation
