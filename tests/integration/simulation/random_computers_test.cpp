// Whole computers around random boards, each in a process of its own under the monitor: identities and bounds
// hold, results are those of the pictures that were captured, and everything is the same at each fidelity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "models/kernels/stereo.h"
#include "platform/board_yaml.h"
#include "sw/report/stats_json.h"
#include "sw/simulation/camera_simulation.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/noise_picture.h"
#include "tests/support/random_board.h"

namespace stereotlm::simulation {
namespace {

using fpga::Fidelity;
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

struct Outcome {
  std::vector<Result> results;
  std::vector<fpga::RowProfile> rows;  // if they were asked for
  platform::Statistics statistics;
};

Outcome simulate(const BoardConfig& board, const platform::Tables& tables, std::uint64_t frames,
                 Fidelity fidelity, bool with_rows = false) {
  Noise pairs(board);
  test::MonitoringBinder binder;
  CameraSimulation simulation(board, tables, pairs, frames, binder, fidelity);
  if (with_rows) simulation.record_rows();
  Outcome outcome;
  while (!simulation.finished()) {
    for (Result& result : simulation.advance()) outcome.results.push_back(std::move(result));
  }
  outcome.rows = simulation.take_rows();
  outcome.statistics = simulation.statistics();
  return outcome;
}

// What is wrong with a run of this board.
std::string problems_of_run(const BoardConfig& board, const platform::Tables& tables, std::uint64_t frames,
                            Fidelity fidelity) {
  const Outcome outcome = simulate(board, tables, frames, fidelity);
  std::string text;
  for (const std::string& failed : outcome.statistics.failed) text += failed + '\n';
  for (const platform::CameraStatistics& camera : outcome.statistics.computer->cameras) {
    if (camera.dropped_pixels > 0) return text;  // the pictures are not those of the cameras
    if (board.cameras.trigger == platform::CameraTrigger::kOnDemand && camera.dropped_frames > 0)
      text += "a camera on demand has dropped a frame\n";
  }
  const kernels::StereoConfig config{board.matcher.window, board.matcher.disparities, board.matcher.filter,
                                     board.matcher.lr_tolerance};
  Noise pairs(board);
  for (const Result& result : outcome.results) {
    const host::StereoPair& pair = pairs.pair(result.number);
    if (result.disparity !=
        kernels::disparity_image(pair.left, pair.right, pointer(tables.left), pointer(tables.right), config))
      text += "camera frame " + std::to_string(result.number) + ": wrong disparities\n";
  }
  return text;
}

struct Computer {
  explicit Computer(std::uint64_t seed) {
    const test::RandomBoard random_board = test::make_random_board(seed);
    board = test::board_config(random_board);
    tables = test::board_tables(random_board);
    SplitMix64 random(seed + 1'000'000);
    surround(board, random);
    frames = static_cast<std::uint64_t>(random.between(1, 6));
  }
  BoardConfig board;
  platform::Tables tables;
  std::uint64_t frames = 1;
};

std::string problems_of_random_run(std::uint64_t seed, Fidelity fidelity) {
  const Computer computer(seed);
  const std::string wrong = problems_of_run(computer.board, computer.tables, computer.frames, fidelity);
  return wrong.empty() ? wrong : wrong + platform::to_yaml(computer.board);
}

// All that a run tells, but for the name of the fidelity; of every second one also its rows.
std::string report_of_random_run(std::uint64_t seed, Fidelity fidelity) {
  const Computer computer(seed);
  Outcome outcome = simulate(computer.board, computer.tables, computer.frames, fidelity, seed % 2 == 1);
  outcome.statistics.fidelity = "any";
  std::string text = report::stats_json(outcome.statistics, std::nullopt);
  for (const Result& result : outcome.results)
    text += "camera frame " + std::to_string(result.number) + " at " + std::to_string(result.time_ps) + '\n';
  for (const fpga::RowProfile& rows : outcome.rows) {
    for (const fpga::RowEnd& row : rows) {
      text += "row whole after " + std::to_string(row.cycles) + ", stalls";
      for (const std::uint64_t stalls : row.stalls) text += ' ' + std::to_string(stalls);
      text += '\n';
    }
  }
  return text;
}

std::uint64_t computers() {
  const char* text = std::getenv("STEREOTLM_RANDOM_COMPUTERS");
  return text != nullptr ? std::stoull(text) : 100;
}

int processors() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

class RandomComputers : public testing::TestWithParam<Fidelity> {};

TEST_P(RandomComputers, KeepTheirIdentitiesAndBoundsAndComputeWhatTheyCaptured) {
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < computers(); ++seed)
    jobs.push_back([seed] { return problems_of_random_run(seed, GetParam()); });
  const std::vector<test::ChildResult> results = test::run_in_children(jobs, processors());
  for (std::size_t seed = 0; seed < results.size(); ++seed)
    EXPECT_TRUE(results[seed].ok()) << "seed " << seed << ":\n" << results[seed].text;
}

INSTANTIATE_TEST_SUITE_P(Fidelities, RandomComputers, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         [](const auto& suite) {
                           return std::string(suite.param == Fidelity::kCycle ? "Cycle" : "Fast");
                         });

TEST(RandomComputersReports, AreTheSameAtEachFidelity) {
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < computers(); ++seed) {
    for (const Fidelity fidelity : {Fidelity::kCycle, Fidelity::kFast, Fidelity::kTiming})
      jobs.push_back([seed, fidelity] { return report_of_random_run(seed, fidelity); });
  }
  const std::vector<test::ChildResult> reports = test::run_in_children(jobs, processors());
  for (std::size_t job = 0; job < reports.size(); job += 3) {
    const std::string& cycle = reports[job].text;
    ASSERT_EQ(cycle.front(), '{') << "seed " << job / 3 << ": " << cycle;
    EXPECT_EQ(cycle, reports[job + 1].text) << "fast, seed " << job / 3;
    EXPECT_EQ(cycle, reports[job + 2].text) << "without pixels, seed " << job / 3;
  }
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
  EXPECT_EQ(problems_of_run(board, platform::identity_tables(board), 30, Fidelity::kCycle), "");
}

}  // namespace
}  // namespace stereotlm::simulation
