// Whole computers around random boards, each in a process of its own under the monitor, against the plain
// loop over events: every figure, time and pixel, at each fidelity.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "models/host/frame_source.h"
#include "models/testing/monitoring_binder.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/bounds.h"
#include "sw/explore/plan/points.h"
#include "sw/process/child.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/record_csv.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/plain_computer.h"
#include "tests/support/plain_conflicts.h"
#include "tests/support/random_computer.h"

namespace stereotlm::simulation {
namespace {

using fpga::Fidelity;

// What the cameras see.
class Pictures : public host::FrameSource {
 public:
  // `board` outlives this object.
  explicit Pictures(const test::RandomBoard& board) : board_(board) {}
  const host::StereoPair& pair(std::uint64_t number) override {
    pair_ = test::stereo_pair(board_, test::camera_pictures(board_, number));
    return pair_;
  }

 private:
  const test::RandomBoard& board_;
  host::StereoPair pair_;
};

struct Outcome {
  std::vector<runs::Result> results;
  std::vector<fpga::RowProfile> rows;
  std::string timeline;  // CSV
  std::string latencies;
  platform::Statistics statistics;
};

Outcome simulate(const platform::BoardConfig& board, const platform::Tables& tables, host::FrameSource& pairs,
                 std::uint64_t frames, Fidelity fidelity) {
  test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
  runs::CameraSimulation simulation(board, tables, pairs, frames, binder, fidelity);
  simulation.core().record_rows();
  simulation.record_timeline();
  Outcome outcome;
  simulation.run([&] {
    for (runs::Result& result : simulation.take_results()) outcome.results.push_back(std::move(result));
    const platform::TimelineRecords records = simulation.take_timeline();
    outcome.timeline += stats::timeline_csv(records.events);
    outcome.latencies += stats::latency_csv(records.latencies);
  });
  outcome.rows = simulation.core().take_rows();
  outcome.statistics = simulation.statistics();
  return outcome;
}

// One figure a line, under the names of stats.json. What the models and the plain computer say is compared as
// such a text.
class Figures {
 public:
  template <typename... Values>
  void line(const std::string& name, Values&&... values) {
    text_ += name;
    ((text_ += fmt::format(" {}", std::forward<Values>(values))), ...);
    text_ += '\n';
  }
  void decimal(const std::string& name, double value) { line(name, fmt::format("{:.12g}", value)); }
  void pixels(std::uint64_t camera_frame, const std::vector<std::uint8_t>& disparity) {
    line(fmt::format("disparities of camera frame {}", camera_frame), fmt::join(disparity, ","));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string figures_of(const Outcome& outcome, bool with_pixels) {
  const platform::Statistics& statistics = outcome.statistics;
  const platform::ComputerStatistics& computer = *statistics.computer;
  Figures figures;
  for (const runs::Result& result : outcome.results) {
    figures.line("delivered", result.number, result.time_ps);
    if (with_pixels) figures.pixels(result.number, result.disparity.pixels);
  }
  figures.line("cycles", statistics.cycles);
  figures.line("frame_cycles", fmt::join(statistics.frame_cycles, " "));
  figures.decimal("frames_per_second.core", statistics.frames_per_second.core);
  figures.decimal("frames_per_second.system", *statistics.frames_per_second.system);
  if (const auto& steady = statistics.frames_per_second.steady) {
    figures.decimal("frames_per_second.steady", steady->frames_per_second);
    figures.decimal("frames_per_second.steady_uncertainty", steady->uncertainty);
  }
  for (const platform::BankStatistics& bank : statistics.banks) {
    figures.line("bank " + bank.name, bank.reads, bank.writes, bank.busy_cycles, bank.turnaround_cycles,
                 bank.idle_cycles, bank.contended_cycles, bank.row_cycles.value_or(0),
                 bank.refresh_cycles.value_or(0));
  }
  for (const platform::PortStatistics& port : statistics.ports) {
    figures.line("port " + port.name, port.grants, port.stall_cycles, port.passed_cycles, port.idle_cycles,
                 port.blocked_cycles, port.starved_cycles);
  }
  for (const platform::BlameRow& row : statistics.blame)
    figures.line("blame", row.port, row.bank, row.by, row.cycles);
  for (const fpga::RowProfile& rows : outcome.rows) {
    for (const fpga::RowEnd& row : rows) figures.line("row", row.cycles, fmt::join(row.stalls, " "));
  }
  figures.line("pci", computer.pci_clocks, computer.pci_busy_clocks);
  for (const platform::PciMasterStatistics& master : computer.pci_masters)
    figures.line("pci master " + master.name, master.transactions, master.words, master.wait_clocks);
  figures.line("bridge", computer.posted_words, computer.dma_words, computer.local_clocks,
               computer.local_busy_clocks);
  for (const platform::CameraStatistics& camera : computer.cameras) {
    figures.line("camera " + camera.name, camera.frames, camera.captured_frames, camera.dropped_not_armed,
                 camera.dropped_busy, camera.dropped_by_partner, camera.dropped_pixels);
  }
  const platform::Percentiles& latency = computer.capture_to_host_ms;
  for (const double ms : {latency.min, latency.p50, latency.p95, latency.p99, latency.max})
    figures.decimal("latency_ms", ms);
  return figures.text();
}

// The frames after which every list of buffers begins anew.
std::size_t turn_of(const test::PlainCycleInput& board) {
  std::size_t turn = 1;
  while (turn % board.left_image.size() != 0 || turn % board.right_image.size() != 0 ||
         turn % board.disparity.size() != 0)
    ++turn;
  return turn;
}

std::string figures_of(const test::PlainComputerResult& plain, const test::PlainComputerInput& input,
                       bool with_pixels) {
  Figures figures;
  std::vector<test::PlainTime> latencies;
  for (const test::PlainDelivery& delivery : plain.deliveries) {
    figures.line("delivered", delivery.camera_frame, delivery.host_ps);
    if (with_pixels) figures.pixels(delivery.camera_frame, delivery.disparity);
    latencies.push_back(delivery.host_ps - delivery.begin_ps);
  }
  const test::PlainCycleResult& core = plain.core;
  figures.line("cycles", core.counted_cycles);
  figures.line("frame_cycles", fmt::join(core.frame_cycles, " "));
  const double frames = static_cast<double>(plain.deliveries.size());
  const test::PlainTime last_ps = plain.deliveries.back().host_ps;
  double cycles = 0;
  for (const std::uint64_t frame : core.frame_cycles) cycles += static_cast<double>(frame);
  const test::PlainNumber& mhz = input.board.clock_mhz;
  figures.decimal("frames_per_second.core", 1e6 * static_cast<double>(mhz.numerator) /
                                                static_cast<double>(mhz.denominator) * frames / cycles);
  figures.decimal("frames_per_second.system", frames * 1e12 / static_cast<double>(last_ps));
  const std::size_t turn = turn_of(input.board.core);
  std::size_t window = 0;
  while (turn + window + turn <= plain.deliveries.size()) window += turn;
  if (window > 0) {
    const std::size_t before = plain.deliveries.size() - 1 - window;
    const double window_ps = static_cast<double>(last_ps - plain.deliveries[before].host_ps);
    const double steady = static_cast<double>(window) * 1e12 / window_ps;
    const auto first = latencies.begin() + static_cast<std::ptrdiff_t>(before);
    const auto spread = *std::max_element(first, latencies.end()) - *std::min_element(first, latencies.end());
    figures.decimal("frames_per_second.steady", steady);
    figures.decimal("frames_per_second.steady_uncertainty", steady * static_cast<double>(spread) / window_ps);
  }
  for (std::size_t index = 0; index < core.banks.size(); ++index) {
    const test::PlainBankStates& bank = core.banks[index];
    figures.line(fmt::format("bank bank{}", index), bank.reads, bank.writes, bank.busy, bank.turnaround,
                 bank.idle, bank.contended, bank.row, bank.refresh);
  }
  for (std::size_t index = 0; index < core.ports.size(); ++index) {
    const test::PlainPortStates& port = core.ports[index];
    figures.line("port " + core.names[index], port.granted, port.stalled, port.passed, port.idle,
                 port.blocked, port.starved);
  }
  for (const auto& [who, lost] : core.blame)
    figures.line("blame", core.names[who.port], fmt::format("bank{}", who.bank), core.names[who.by], lost);
  for (const auto& rows : core.rows) {
    for (const test::PlainRowEnd& row : rows)
      figures.line("row", row.cycles, fmt::join(row.stalls.begin(), row.stalls.end() - 1, " "));
  }
  figures.line("pci", plain.pci_clocks, plain.pci_busy_clocks);
  const std::vector<std::string> masters = {"host", "left_capture", "right_capture", "bridge", "load"};
  for (std::size_t index = 0; index < plain.masters.size(); ++index) {
    const test::PlainPciBus::MasterStats& master = plain.masters[index];
    figures.line("pci master " + masters[index], master.transactions, master.words, master.wait_clocks);
  }
  figures.line("bridge", plain.posted_words, plain.dma_words, plain.local_clocks, plain.local_busy_clocks);
  for (std::size_t side = 0; side < plain.cameras.size(); ++side) {
    const test::PlainCaptureBoard::Stats& capture = plain.cameras[side].capture;
    figures.line(side == 0 ? "camera left" : "camera right", plain.cameras[side].frames,
                 capture.captured_frames, capture.dropped_not_armed, capture.dropped_busy,
                 capture.dropped_by_partner, capture.dropped_pixels);
  }
  std::sort(latencies.begin(), latencies.end());
  for (const std::size_t percent : std::array<std::size_t, 5>{0, 50, 95, 99, 100}) {  // nearest rank
    const std::size_t rank = std::max<std::size_t>(1, (latencies.size() * percent + 99) / 100);
    figures.decimal("latency_ms", static_cast<double>(latencies[rank - 1]) / 1e9);
  }
  return figures.text();
}

// What `differences` says of the runs at these fidelities, each in a process of its own.
std::string differences_at(const std::vector<Fidelity>& fidelities,
                           const std::function<std::string(Fidelity)>& differences) {
  std::string text;
  for (const Fidelity fidelity : fidelities) {
    const test::ChildResult result = test::run_in_child([&] { return differences(fidelity); });
    if (!result.ok()) text += fmt::format("fidelity {}: {}\n", static_cast<int>(fidelity), result.text);
  }
  return text;
}

// What is wrong if a run is faster than the bound beside its rate, or than steady_bound(). The steady rate of
// a run that loses pixels has neither.
std::string above_bound(const platform::BoardConfig& board, const platform::Tables& tables,
                        const platform::Statistics& statistics) {
  const auto& steady = statistics.frames_per_second.steady;
  const auto& rates = statistics.frames_per_second;
  const double rate = steady ? steady->frames_per_second - steady->uncertainty : 0;
  const bool is_whole = platform::lost_pixels(statistics) == 0;
  if (rates.core > statistics.bound.core || (is_whole && rate > *statistics.bound.system * (1 + 1e-9)))
    return fmt::format("{} and {} frames/s, above {} or {}\n", rates.core, rate, statistics.bound.core,
                       *statistics.bound.system);
  if (!steady || !is_whole) return "";
  const double bound = platform::steady_bound(board, platform::frame_accesses(board, tables));
  const double least = steady->frames_per_second - steady->uncertainty;
  return least <= bound * (1 + 1e-9) ? "" : fmt::format("{} frames/s, above the bound of {}\n", least, bound);
}

// Where runs of the models are not what they should be.
std::string problems_of(std::uint64_t seed, const test::RandomKnobs& knobs) {
  const test::RandomComputer computer = test::make_random_computer(seed, knobs);
  const platform::BoardConfig board = test::board_config(computer);
  const platform::Tables tables = test::board_tables(computer.board);
  const test::PlainComputerInput& input = computer.input;
  const test::PlainComputerResult plain = test::run_plain_computer(input);
  const auto differences = [&](Fidelity fidelity) {
    Pictures pictures(computer.board);
    const Outcome outcome =
        simulate(board, tables, pictures, static_cast<std::uint64_t>(input.frames), fidelity);
    const bool with_pixels = fpga::has_pixels(fidelity);
    std::string text =
        test::differing_lines(figures_of(plain, input, with_pixels), figures_of(outcome, with_pixels));
    text += test::differing_lines(
        test::plain_energy(input.board.core, plain.core, plain.core.work, plain.deliveries.back().host_ps),
        test::energy_text(outcome.statistics));
    for (const std::string& failed : outcome.statistics.failed) text += failed + '\n';
    return text + above_bound(board, tables, outcome.statistics);
  };
  const std::string text = differences_at(
      {Fidelity::kCycle, Fidelity::kCycleTiming, Fidelity::kFast, Fidelity::kTiming}, differences);
  return text.empty() ? text : text + platform::to_yaml(board);
}

std::uint64_t computers(std::uint64_t otherwise = 200) { return test::random_computers(otherwise); }

int processors() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

// Computers with the knobs of contract section 7, or without them.
class RandomComputers : public testing::TestWithParam<bool> {
 protected:
  // `problems(seed, knobs)` finds none in any of them.
  static void expect_none(
      std::uint64_t count,
      const std::function<std::string(std::uint64_t, const test::RandomKnobs&)>& problems) {
    test::RandomKnobs knobs = GetParam() ? test::RandomKnobs::with_section_8() : test::RandomKnobs{};
    knobs.large_images = false;  // they take minutes under the sanitizers; the random boards have them
    std::vector<std::uint64_t> seeds(count);
    std::iota(seeds.begin(), seeds.end(), std::uint64_t{0});
    // Of computers that once showed an error which the first ones do not show: with steps of the matcher of
    // several cycles the end of a frame was noticed too late.
    // The first alone shows some wrong changes.
    seeds.insert(seeds.end(), {140, 819, 1126, 2616});
    std::vector<test::ChildWork> jobs;
    for (const std::uint64_t seed : seeds) jobs.push_back([&, seed] { return problems(seed, knobs); });
    const std::vector<test::ChildResult> results =
        test::run_in_children(jobs, processors(), std::chrono::seconds(200));
    for (std::size_t job = 0; job < results.size(); ++job)
      EXPECT_TRUE(results[job].ok()) << "seed " << seeds[job] << ":\n" << results[job].text;
  }
};

TEST_P(RandomComputers, EqualThePlainLoopOverEvents) { expect_none(computers(), problems_of); }

TEST_P(RandomComputers, HaveTheSameTimeLineAtEachFidelity) {
  test::RandomKnobs knobs = GetParam() ? test::RandomKnobs::with_section_8() : test::RandomKnobs{};
  knobs.large_images = false;
  constexpr std::array kFidelities = {Fidelity::kCycle, Fidelity::kFast, Fidelity::kTiming};
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < computers(); ++seed) {
    for (const Fidelity fidelity : kFidelities) {
      jobs.push_back([seed, knobs, fidelity] {
        const test::RandomComputer computer = test::make_random_computer(seed, knobs);
        Pictures pictures(computer.board);
        const auto frames = static_cast<std::uint64_t>(computer.input.frames);
        const Outcome outcome = simulate(test::board_config(computer), test::board_tables(computer.board),
                                         pictures, frames, fidelity);
        return outcome.timeline + outcome.latencies;
      });
    }
  }
  const std::vector<test::ChildResult> results =
      test::run_in_children(jobs, processors(), std::chrono::seconds(200));
  for (std::size_t job = 0; job < results.size(); ++job) {
    const std::string seed = fmt::format("seed {}: ", job / kFidelities.size());
    const std::string& cycle = results[job - job % kFidelities.size()].text;
    ASSERT_EQ(results[job].exit_status, 1) << seed << results[job].text;  // its text is the result
    EXPECT_NE(cycle.find("\nwait,core,0,"), std::string::npos) << seed;
    EXPECT_EQ(test::differing_lines(cycle, results[job].text), "") << seed;
  }
}

// What differs in rows.csv and conflicts.csv between runs and the plain loop over events.
std::string conflicts_that_differ(std::uint64_t seed, const test::RandomKnobs& knobs) {
  const test::RandomComputer computer = test::make_random_computer(seed, knobs);
  const platform::BoardConfig board = test::board_config(computer);
  const platform::Tables tables = test::board_tables(computer.board);
  const test::PlainComputerInput& input = computer.input;
  const test::PlainCycleResult core = test::run_plain_computer(input).core;
  const auto differences = [&](Fidelity fidelity) {
    Pictures pictures(computer.board);
    test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
    runs::CameraSimulation simulation(board, tables, pictures, static_cast<std::uint64_t>(input.frames),
                                      binder, fidelity);
    simulation.record_conflicts();
    std::string rows = stats::rows_csv_head(board);
    std::uint64_t frames = 0;
    simulation.run([&] {
      for (const fpga::FrameConflicts& frame : simulation.take_conflicts())
        rows += stats::rows_csv(board, frames++, frame);
    });
    std::string text = test::differing_lines(test::plain_rows_csv(input.board.core, core.strips), rows);
    text += test::differing_lines(test::plain_conflicts_csv(input.board.core, core.tiles),
                                  stats::conflicts_csv(board, *simulation.conflicts()));
    for (const std::string& failed : simulation.statistics().failed) text += failed + '\n';
    return text;
  };
  const std::string text = differences_at({Fidelity::kCycle, Fidelity::kTiming}, differences);
  return text.empty() ? text : text + platform::to_yaml(board);
}

TEST_P(RandomComputers, HaveTheConflictsOfThePlainLoop) {
  expect_none(computers(100), conflicts_that_differ);
}

INSTANTIATE_TEST_SUITE_P(Knobs, RandomComputers, testing::Bool(),
                         [](const auto& suite) { return suite.param ? "With" : "Without"; });

// What is wrong with the steady rate of the default number of frames, beside that of many.
std::string steady_problems(std::uint64_t seed) {
  test::RandomKnobs knobs = test::RandomKnobs::all();
  knobs.large_images = false;
  const test::RandomComputer computer = test::make_random_computer(seed, knobs);
  const platform::BoardConfig board = test::board_config(computer);
  const platform::Tables tables = test::board_tables(computer.board);
  const auto run = [&](std::uint64_t frames) {
    Pictures pictures(computer.board);
    test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
    runs::CameraSimulation simulation(board, tables, pictures, frames, binder, Fidelity::kTiming);
    simulation.run([] {});
    return simulation.statistics();
  };
  constexpr std::uint64_t kMany = 400;
  std::array<std::string, 2> texts;  // each in a process of its own
  for (const bool is_long : {false, true}) {
    process::Child child([&](const process::Child::Tell& tell) {
      const platform::Statistics statistics = run(is_long ? kMany : explore::frames_of({true, 0, ""}, board));
      tell(fmt::format("{} {} {}", statistics.frames_per_second.steady->frames_per_second,
                       statistics.frames_per_second.steady->uncertainty, fmt::join(statistics.failed, "; ")) +
           above_bound(board, tables, statistics));
    });
    texts[is_long ? 1 : 0] = child.next().value();
    child.next();
  }
  std::array<double, 2> rates{};
  std::array<double, 2> uncertainties{};
  for (std::size_t i = 0; i < 2; ++i) {
    std::istringstream text(texts[i]);
    std::string failed;
    text >> rates[i] >> uncertainties[i];
    std::getline(text, failed);
    if (failed != " ") return texts[i];
  }
  // The window has a sample of the latencies. Clocks that beat slowly show more of them in more frames.
  const double allowed = 1.25 * uncertainties[0] + 1e-5 * rates[0];
  if (std::abs(rates[0] - rates[1]) <= allowed) return "";
  return fmt::format("{}\n{}\n{}", texts[0], texts[1], platform::to_yaml(board));
}

TEST(RandomSteadyRates, AreWithinTheirUncertaintyOfTheRateOfManyFrames) {
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < computers() / 4; ++seed)  // 400 frames take long under the sanitizers
    jobs.push_back([seed] { return steady_problems(seed); });
  const std::vector<test::ChildResult> results =
      test::run_in_children(jobs, processors(), std::chrono::seconds(200));
  for (std::size_t seed = 0; seed < results.size(); ++seed)
    EXPECT_TRUE(results[seed].ok()) << "seed " << seed << ":\n" << results[seed].text;
}

// The bridge copies pictures as fast as it can. Returns the rate as a share of its bound, or what has failed.
std::string share_of_bound(double local_mhz, int burst_words) {
  const platform::BoardConfig board = platform::load_board(
      "fpl2003-no-calibration",
      {"image={width: 64, height: 48}", "matcher.disparities=1", "matcher.window=3", "matcher.filter=none",
       "matcher.fetch=line_buffer", "cameras.frame_rate_hz=1000", "capture.destination=host_memory",
       "capture.host_frames=4", "pci.clock_mhz=1000", "fpga.clock_mhz=3",
       fmt::format("bridge={{local_clock_mhz: {}, dma_burst_words: {}, posted_words: 64}}", local_mhz,
                   burst_words)});
  const platform::Statistics all =
      simulate(board, platform::identity_tables(board), *runs::blank_pairs(board), 13, Fidelity::kTiming)
          .statistics;
  if (!all.failed.empty()) return all.failed.front();
  return fmt::format("{}", all.frames_per_second.steady->frames_per_second / *all.bound.system);
}

TEST(SaturatedLocalBus, StaysBelowItsBoundAndComesCloseToItWithAnyClocks) {
  test::SplitMix64 random(1);
  std::vector<test::ChildWork> jobs = {[] { return share_of_bound(12, 1); }};  // four clocks hide in a cycle
  while (jobs.size() < 60) {
    const double local_mhz = random.between(1000, 4000) / 1000.0;
    jobs.push_back([local_mhz, words = std::array{20, 32, 100}[jobs.size() % 3]] {
      return share_of_bound(local_mhz, words);
    });
  }
  int close = 0;
  for (const test::ChildResult& result :
       test::run_in_children(jobs, processors(), std::chrono::seconds(200))) {
    const double share = std::atof(result.text.c_str());
    EXPECT_GT(share, 0.65) << result.text;
    if (share > 0.93) ++close;
  }
  EXPECT_GE(close,
            48);  // at some ratios of the clocks not every phase of a burst is as quick as the best one
}

}  // namespace
}  // namespace stereotlm::simulation
