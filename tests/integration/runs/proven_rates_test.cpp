// The rates that contract 7.12 proves, beside those of long runs of random computers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "models/testing/monitoring_binder.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/bounds.h"
#include "platform/figures/proven_rate.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/plan/points.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "sw/runs/sources/open_source.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/random_computer.h"

namespace stereotlm::simulation {
namespace {

using platform::BoardConfig;

// A computer like that of the paper, in small: most buffers in banks of their own, and buses with time to
// spare. Its cameras are about as quick as its core.
BoardConfig usual_computer(std::uint64_t seed, BoardConfig board) {
  test::SplitMix64 random(seed + 7'000'000);
  const BoardConfig usual;
  board.image = {4 * random.between(8, 24), random.between(20, 48)};
  board.capture.fifo_words = 140;
  board.capture.fifo_trigger_words = 32;
  board.pci = usual.pci;
  board.pci.clock_mhz = random.chance(70) ? 33.333 : random.between(300, 1333) / 10.0;
  board.bridge = usual.bridge;
  if (random.chance(70)) board.fpga.clock_mhz = 40;
  board.fpga.lanes = 1;
  board.matcher.disparities = 240;  // in many folds
  board.matcher.units = random.between(1, 5);
  board.banks.clear();
  const auto bank = [&] {
    if (!board.banks.empty() && random.chance(4)) return board.banks.front().name;
    platform::BankConfig& its = board.banks.emplace_back();
    its.name = fmt::format("bank{}", board.banks.size() - 1);
    its.kind = std::vector{memory::BankKind::kZbtPipelined, memory::BankKind::kZbtFlowThrough,
                           memory::BankKind::kQdr, memory::BankKind::kSyncBurst}[random.next() % 4];
    if (its.kind == memory::BankKind::kSyncBurst) its.turnaround_cycles = random.between(1, 3);
    return its.name;
  };
  const auto draw = [&](std::vector<platform::BufferBanks>& list, int entries) {
    list.clear();
    while (static_cast<int>(list.size()) < entries) list.emplace_back(bank());
  };
  const int pictures = random.between(1, 3);
  draw(board.allocation.left_image, pictures);
  draw(board.allocation.right_image, pictures);
  draw(board.allocation.disparity, random.between(1, 3));
  if (board.allocation.left_lut) board.allocation.left_lut = bank();
  if (board.allocation.right_lut)
    board.allocation.right_lut = board.fpga.joint_tables ? *board.allocation.left_lut : bank();
  const double core = platform::core_bound(board, platform::identity_accesses(board)).core;
  board.cameras.frame_rate_hz = std::clamp(std::round(core * random.between(40, 300)) / 100, 1.0, 400.0);
  return board;
}

// What a run has proven of its rate, and whether longer runs keep to it.
std::string problems_of(const BoardConfig& board, std::uint64_t frames, bool& is_exact) {
  const platform::Tables tables = platform::identity_tables(board);
  const auto pictures = runs::blank_pairs(board);
  const auto run = [&](std::uint64_t count, std::vector<runs::Result>& results) {
    test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
    runs::CameraSimulation simulation(board, tables, *pictures, count, binder, fpga::Fidelity::kTiming);
    simulation.run([&] {
      for (runs::Result& result : simulation.take_results()) {
        result.disparity = {};
        results.push_back(std::move(result));
      }
    });
    return simulation.statistics();
  };
  // The first frames are those of a short run. So one run has both.
  std::vector<runs::Result> results;
  platform::Statistics statistics = run(frames, results);
  const auto& all = statistics.frames_per_second.proven;
  if (!all) return platform::lost_pixels(statistics) > 0 ? "" : "nothing is proven of a run without losses";
  const std::vector<std::uint64_t> of_short(
      statistics.frame_cycles.begin(),
      statistics.frame_cycles.begin() +
          static_cast<std::ptrdiff_t>(explore::frames_of({true, 0, ""}, board)));
  const auto accesses = platform::frame_accesses(board, tables);
  const auto proven = platform::proven_rate(board, accesses, of_short, *statistics.bound.system);
  const std::size_t from = frames / 4;
  const std::size_t counted = frames - 1 - from;
  const double rate = 1e12 * static_cast<double>(counted) /
                      static_cast<double>(results.back().time_ps - results[from].time_ps);
  const double cut = 4.0 / static_cast<double>(counted);  // deliveries of a pattern that the window cuts
  std::string text;
  const auto alone =
      platform::proven_rate(board, accesses,
                            platform::core_frame_cycles(board, platform::access_patterns(board, &tables),
                                                        platform::allocation_period_frames(board)),
                            platform::steady_bound(board, accesses));  // as searches take it
  for (const platform::ProvenRate& its : {*proven, *all, *alone}) {
    if (its.least > its.most || rate < its.least * (1 - cut) || rate > its.most * (1 + cut))
      text += fmt::format("{} frames/s of {} frames, not in {} .. {}\n", rate, frames, its.least, its.most);
    if (!its.exact) continue;
    is_exact = true;
    for (std::size_t frame = from; frame + *its.deliveries < results.size(); ++frame) {
      const std::uint64_t passed = results[frame + *its.deliveries].number - results[frame].number;
      if (passed == *its.camera_frames) continue;
      text += fmt::format("frame {}: {} camera frames for {} deliveries, not {}\n", frame, passed,
                          *its.deliveries, *its.camera_frames);
      break;
    }
  }
  return text.empty() ? "" : text + platform::to_yaml(board);
}

TEST(ProvenRates, HoldTheRatesOfLongRunsOfRandomComputers) {
  const std::uint64_t asked = test::random_computers(0);
  const std::uint64_t computers = asked == 0 ? 24 : asked;
  const std::uint64_t frames = asked == 0 ? 400 : 20'000;
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < computers; ++seed) {
    jobs.push_back([seed, frames] {
      test::RandomKnobs knobs = seed % 2 == 0 ? test::RandomKnobs{} : test::RandomKnobs::all();
      knobs.large_images = false;
      const BoardConfig drawn = test::board_config(test::make_random_computer(seed, knobs));
      const BoardConfig board = seed % 4 < 3 ? usual_computer(seed, drawn) : drawn;
      const std::vector<std::string> invalid = platform::problems(board);
      if (!invalid.empty()) return invalid.front();
      bool is_exact = false;
      const std::string problems = problems_of(board, frames, is_exact);
      return !problems.empty() ? problems : is_exact ? std::string("exact") : "";
    });
  }
  const int parallel = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const auto results = test::run_in_children(jobs, parallel, std::chrono::seconds(asked == 0 ? 200 : 20'000));
  std::uint64_t exact = 0;
  for (std::size_t seed = 0; seed < results.size(); ++seed) {
    exact += results[seed].text == "exact" ? 1 : 0;
    EXPECT_TRUE(results[seed].ok() || results[seed].text == "exact") << "seed " << seed << ":\n"
                                                                     << results[seed].text;
  }
  EXPECT_GE(exact, computers / 8);
}

}  // namespace
}  // namespace stereotlm::simulation
