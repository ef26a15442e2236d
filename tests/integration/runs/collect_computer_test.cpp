// Identities of the computer, checked with the counters of a valid run of which one is changed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "models/fpga/local_bus.h"
#include "models/testing/monitoring_binder.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/collect.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::simulation {
namespace {

using platform::ComputerCounters;
using platform::Delivery;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class CollectComputer : public testing::Test {
 protected:
  CollectComputer() {
    simulation.run([] {});
    // The core is idle: as many frames as deliveries.
    counters = simulation.computer().counters();
  }
  platform::Statistics statistics() {
    return platform::collect_statistics(board, tables, "cycle", simulation.computer().core().frame_cycles(),
                                        counters, deliveries);
  }

  platform::BoardConfig board = platform::load_board(
      "fpl2003",
      {"image.width=32", "image.height=24", "matcher.disparities=8", "cameras.frame_rate_hz=1000"});
  platform::Tables tables = platform::identity_tables(board);
  test::NoisePairs pairs{32, 24};
  test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
  runs::CameraSimulation simulation{board, tables, pairs, 5, binder};
  ComputerCounters counters;
  std::vector<Delivery> deliveries = {
      {1'000'000'000, 3'000'000'000},  {2'000'000'000, 5'000'000'000},   {4'000'000'000, 9'000'000'000},
      {8'000'000'000, 11'000'000'000}, {10'000'000'000, 14'000'000'000},
  };
};

TEST_F(CollectComputer, TakesRatesAndLatenciesFromTheDeliveries) {
  const platform::Statistics found = statistics();
  EXPECT_THAT(found.failed, IsEmpty());
  EXPECT_DOUBLE_EQ(*found.frames_per_second.system, 5 / 14e-3);
  const platform::Percentiles& latency = found.computer->capture_to_host_ms;
  EXPECT_EQ(latency.min, 2);
  EXPECT_EQ(latency.p50, 3);  // nearest rank: the third of five
  EXPECT_EQ(latency.p95, 5);
  EXPECT_EQ(latency.p99, 5);
  EXPECT_EQ(latency.max, 5);

  deliveries.clear();
  for (std::uint64_t i = 0; i < 100; ++i) deliveries.push_back({0, (100 - i) * 1'000'000'000});
  const platform::Percentiles of_hundred = statistics().computer->capture_to_host_ms;
  EXPECT_EQ(of_hundred.min, 1);
  EXPECT_EQ(of_hundred.p50, 50);
  EXPECT_EQ(of_hundred.p95, 95);
  EXPECT_EQ(of_hundred.p99, 99);
  EXPECT_EQ(of_hundred.max, 100);

  deliveries.resize(12);
  EXPECT_EQ(statistics().computer->capture_to_host_ms.p95, 100) << "0.95 * 12 rounded up: the last";
}

// The lists have two buffers. So two deliveries are warm-up, and the window has whole pairs of frames.
TEST_F(CollectComputer, TakesTheSteadyRateOverWholeTurnsOfTheLists) {
  const auto steady = [this](std::size_t count) {
    const std::vector<Delivery> all = deliveries;
    deliveries.resize(count);
    const auto found = statistics().frames_per_second.steady;
    deliveries = all;
    return found;
  };
  EXPECT_FALSE(steady(3));
  ASSERT_TRUE(steady(4));
  EXPECT_EQ(steady(4)->frames, 2U);
  EXPECT_DOUBLE_EQ(steady(4)->frames_per_second, 2 / 6e-3);    // from 5 ms to 11 ms
  EXPECT_DOUBLE_EQ(steady(4)->uncertainty, 2 / 6e-3 * 2 / 6);  // latencies: 3, 5 and 3 ms
  EXPECT_EQ(steady(5)->frames, 2U);
  EXPECT_DOUBLE_EQ(steady(5)->frames_per_second, 2 / 5e-3);    // from 9 ms to 14 ms
  EXPECT_DOUBLE_EQ(steady(5)->uncertainty, 2 / 5e-3 * 2 / 5);  // latencies: 5, 3 and 4 ms
  deliveries.push_back({14'000'000'000, 17'000'000'000});
  EXPECT_EQ(steady(6)->frames, 4U);
  EXPECT_DOUBLE_EQ(steady(6)->frames_per_second, 4 / 12e-3);
}

// The cameras give 1000 frames a second.
TEST_F(CollectComputer, FindsASteadyRateAboveItsBoundByMoreThanItsUncertainty) {
  const auto deliver = [this](std::uint64_t last_capture_ps) {
    deliveries = {{0, 30'000'000'000},
                  {0, 40'000'000'000},
                  {0, 41'000'000'000},
                  {40'000'000'000, 41'300'000'000},
                  {last_capture_ps, 41'600'000'000}};
    return statistics();
  };
  // Two frames in 0.6 ms. Their latencies differ by 40 ms.
  EXPECT_THAT(deliver(40'900'000'000).failed, IsEmpty());
  for (Delivery& delivery : deliveries) delivery.capture_ps = delivery.host_ps - 1'000'000'000;
  const platform::Statistics found = statistics();
  EXPECT_THAT(found.failed, ElementsAre(fmt::format("frames_per_second.steady - steady_uncertainty = {}, but "
                                                    "the bound of whole turns = {}",
                                                    found.frames_per_second.steady->frames_per_second,
                                                    *found.bound.system * (1 + 1e-9))));
}

// Each identity is broken by one counter of a valid run. Words that reach a bank break that of its energy,
// too.
TEST_F(CollectComputer, FindsEachIdentityThatDoesNotHold) {
  const ComputerCounters valid = counters;
  const auto expect_failed = [&](const std::string& left, std::uint64_t is, const std::string& right,
                                 std::uint64_t but, const auto& change) {
    counters = valid;
    change(counters);
    const auto failed = statistics().failed;
    EXPECT_THAT(failed, Contains(fmt::format("{} = {}, but {} = {}", left, is, right, but)));
    for (const std::string& each : failed)
      EXPECT_THAT(each, AnyOf(StartsWith(left), StartsWith("energy: bytes of the buffers")));
  };
  std::vector<std::string> names;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) names.push_back(buffer.path());
  names.emplace_back("no buffer");
  ASSERT_EQ(valid.words.into_bridge.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::uint64_t bytes = 4 * valid.words.into_bridge[i];
    const std::string left = "bytes written into the bridge for " + names[i];
    const std::string right = "granted on the host port and still in the bridge";
    expect_failed(left, bytes + 4, right, bytes, [i](auto& found) { ++found.words.into_bridge[i]; });
    for (const auto part : {&ComputerCounters::Words::in_bridge, &ComputerCounters::Words::on_bus,
                            &ComputerCounters::Words::granted}) {
      expect_failed(left, bytes, right, bytes + 4, [i, part](auto& found) { ++(found.words.*part)[i]; });
    }
  }
  const std::uint64_t words = valid.local_bus.words_read + valid.local_bus.words_written;
  for (const auto part : {&fpga::LocalBus::Stats::words_read, &fpga::LocalBus::Stats::words_written}) {
    expect_failed("port host: grants in and between frames", words, "words of the local bus", words + 1,
                  [part](auto& found) { ++(found.local_bus.*part); });
  }
  for (const std::size_t side : {0U, 1U}) {
    const std::string camera = side == 0 ? "camera left: " : "camera right: ";
    const std::uint64_t frames = valid.cameras[side].frames;
    expect_failed(camera + "frames", frames + 1, "captured and dropped", frames,
                  [side](auto& found) { ++found.cameras[side].frames; });
    for (const auto part :
         {&capture::CaptureControl::Stats::started_frames, &capture::CaptureControl::Stats::dropped_not_armed,
          &capture::CaptureControl::Stats::dropped_busy,
          &capture::CaptureControl::Stats::dropped_by_partner}) {
      expect_failed(camera + "frames", frames, "captured and dropped", frames + 1,
                    [side, part](auto& found) { ++(found.cameras[side].capture.*part); });
    }
    const std::uint64_t written = valid.cameras[side].capture.words;
    EXPECT_GT(written, 0U);
    expect_failed(camera + "words written", written + 1, "words of its PCI master", written,
                  [side](auto& found) { ++found.cameras[side].capture.words; });
  }
  EXPECT_GT(words, 0U);
}

TEST_F(CollectComputer, CountsWordsThatWaitInTheBridgeAndOnTheLocalBus) {
  counters.words.into_bridge[0] += 3;
  counters.words.in_bridge[0] += 1;
  counters.words.on_bus[0] += 2;
  EXPECT_THAT(statistics().failed, IsEmpty());
}

TEST_F(CollectComputer, DropsAFrameThatBeginsAtTheEnd) {
  const std::uint64_t dropped = statistics().computer->cameras[0].dropped_frames;
  ++counters.cameras[0].frames;
  counters.cameras[0].undecided = true;
  EXPECT_THAT(statistics().failed, IsEmpty());
  EXPECT_EQ(statistics().computer->cameras[0].dropped_frames, dropped + 1);
}

TEST_F(CollectComputer, FindsMoreDeliveriesThanFramesAndARateAboveItsBound) {
  deliveries.push_back(deliveries.back());
  EXPECT_THAT(statistics().failed, ElementsAre("frames delivered = 6, but frames of the core = 5"));
  deliveries.pop_back();
  EXPECT_THAT(statistics().failed, IsEmpty());
  // The cameras give a frame in 1 ms. The latencies differ by as much as the frames are early.
  deliveries = {{0, 500'000'000}, {0, 600'000'000}, {0, 700'000'000}, {0, 800'000'000}, {0, 900'000'000}};
  EXPECT_THAT(statistics().failed, ElementsAre(StartsWith("frames_per_second.system = 5555.55")));
}

}  // namespace
}  // namespace stereotlm::simulation
