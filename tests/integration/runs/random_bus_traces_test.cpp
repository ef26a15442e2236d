// The traces of the buses and queues of random computers, each run in a process of its own. In windows at random
// places they are the same at each fidelity. The whole trace equals that of the plain loop over events, and its
// sums equal the figures of the run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "platform/bus_trace.h"
#include "platform/config/board_yaml.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "tests/integration/runs/random_pictures.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/plain_computer.h"
#include "tests/support/plain_conflicts.h"
#include "tests/support/random_computer.h"

namespace stereotlm::simulation {
namespace {

using fpga::CycleWindow;
using platform::BusBurst;
using platform::QueueLevel;

// A burst, with a name of its target that stays when the trace is gone.
struct TracedBurst : public BusBurst {
  explicit TracedBurst(const BusBurst& burst) : BusBurst(burst), to(burst.target) {}
  std::string to;
};

struct BusRecords : public platform::BusObserver {
  void burst(const BusBurst& burst) override {
    (burst.bus == BusBurst::Bus::kPci ? pci : local).emplace_back(burst);
  }
  void level(const QueueLevel& level) override { levels[level.queue].push_back(level); }

  std::vector<TracedBurst> pci;
  std::vector<TracedBurst> local;
  std::map<std::string, std::vector<QueueLevel>> levels;
};

// A range of times in which a trace is to be found.
struct TimeRange {
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = UINT64_MAX;
};

// The records of a run in a range, one a line.
std::string text_of(const BusRecords& records, const TimeRange& range = {}) {
  std::string text;
  for (const auto* const bursts : {&records.pci, &records.local}) {
    for (const TracedBurst& burst : *bursts) {
      if (burst.end_ps <= range.begin_ps || burst.request_ps >= range.end_ps) continue;
      text += fmt::format("{} {} {} {} {:x} {} {} {} {} {}\n", bursts == &records.pci ? "pci" : "local",
                          burst.master, burst.to, burst.write, burst.address, burst.words, burst.request_ps,
                          burst.address_ps, burst.data_ps, burst.end_ps);
    }
  }
  for (const auto& [queue, levels] : records.levels) {
    for (const QueueLevel& level : levels) {
      if (level.time_ps <= range.begin_ps || level.time_ps > range.end_ps) continue;
      text += fmt::format("level {} {} {}\n", queue, level.time_ps, level.words);
    }
  }
  return text;
}

// The same, as far as the plain computer has it: without targets, and without addresses of the PCI bus.
std::string plain_part_of(const BusRecords& records) {
  std::string text;
  for (const auto* const bursts : {&records.pci, &records.local}) {
    for (const TracedBurst& burst : *bursts) {
      text += fmt::format("{} {} {:x} {} {} {} {} {}\n", burst.master, burst.write,
                          bursts == &records.pci ? 0 : burst.address, burst.words, burst.request_ps,
                          burst.address_ps, burst.data_ps, burst.end_ps);
    }
  }
  for (const auto& [queue, levels] : records.levels) {
    for (const QueueLevel& level : levels)
      text += fmt::format("{} {} {}\n", queue, level.time_ps, level.words);
  }
  return text;
}

std::string plain_part_of(const test::PlainComputerResult& plain) {
  constexpr std::array<const char*, 5> kMasters = {"host", "left_capture", "right_capture", "bridge", "load"};
  constexpr std::array<const char*, 4> kSources = {"posted", "read", "dma0", "dma1"};
  std::string text;
  const auto add = [&text](const char* name, const test::PlainBusBurst& burst) {
    text += fmt::format("{} {} {:x} {} {} {} {} {}\n", name, burst.write, 4 * burst.word, burst.words,
                        burst.request_ps, burst.address_ps, burst.data_ps, burst.end_ps);
  };
  for (const test::PlainBusBurst& burst : plain.pci_bursts) add(kMasters[burst.source], burst);
  for (const test::PlainBusBurst& burst : plain.local_bursts) add(kSources[burst.source], burst);
  const std::vector<std::pair<const char*, const std::vector<test::PlainLevel>&>> queues = {
      {"left_capture", plain.fifo_levels[0]},
      {"posted", plain.posted_levels},
      {"right_capture", plain.fifo_levels[1]}};
  for (const auto& [queue, levels] : queues) {
    for (const test::PlainLevel& level : levels)
      text += fmt::format("{} {} {}\n", queue, level.time_ps, level.words);
  }
  return text;
}

// Where the sums of a whole trace differ from the figures of its run.
std::string differing_sums(const BusRecords& records, const platform::BoardConfig& board,
                           const platform::ComputerStatistics& figures) {
  const Clock pci(board.pci.clock_mhz);
  const auto clocks = [&pci](std::uint64_t from_ps, std::uint64_t to_ps) {
    return pci.edge_at_or_after(to_ps) - pci.edge_at_or_after(from_ps);
  };
  std::map<std::string, platform::PciMasterStatistics> masters;
  std::uint64_t busy_clocks = 0;
  for (const TracedBurst& burst : records.pci) {
    platform::PciMasterStatistics& master = masters[burst.master];
    ++master.transactions;
    master.words += burst.words;
    master.wait_clocks += clocks(burst.request_ps, burst.address_ps);
    busy_clocks += clocks(burst.address_ps, burst.end_ps);
  }
  std::string text;
  for (const platform::PciMasterStatistics& master : figures.pci_masters) {
    const platform::PciMasterStatistics& sum = masters[master.name];
    if (std::tie(sum.transactions, sum.words, sum.wait_clocks) !=
        std::tie(master.transactions, master.words, master.wait_clocks))
      text += "sums of " + master.name + " differ\n";
  }
  if (busy_clocks != figures.pci_busy_clocks) text += "busy clocks of the PCI bus differ\n";
  std::uint64_t posted = 0;
  std::uint64_t before = 0;
  if (const auto found = records.levels.find("posted"); found != records.levels.end()) {
    for (const QueueLevel& level : found->second) {
      posted += level.words > before ? level.words - before : 0;
      before = level.words;
    }
  }
  if (posted != figures.posted_words) text += "posted words differ\n";
  return text;
}

// A fourth of the computers is traced as a whole, a fourth in a frame of the core, the others in a range of
// cycles.
CycleWindow random_window(std::uint64_t seed, const test::PlainComputerInput& input) {
  test::SplitMix64 random(seed + 5'000'000);
  CycleWindow window;
  if (seed % 4 == 0) return window;
  if (seed % 4 == 1) {
    window.frame = static_cast<std::uint64_t>(random.between(0, input.frames - 1));
    return window;
  }
  const auto number = [](const test::PlainNumber& decimal) {
    return static_cast<double>(decimal.numerator) / static_cast<double>(decimal.denominator);
  };
  const double cycles =
      (input.frames + 1) / number(input.frame_rate_hz) * 1e6 * number(input.board.clock_mhz);
  window.first = static_cast<std::uint64_t>(cycles * random.between(0, 9999) / 1e4);
  window.last =
      window.first + static_cast<std::uint64_t>(cycles) / (std::uint64_t{2} << random.between(0, 12));
  return window;
}

struct TracedRun {
  BusRecords records;
  std::vector<TimeRange> frames;  // of the core, with its start strobe
  platform::Statistics statistics;
};

TracedRun traced_run(const test::RandomComputer& computer, const CycleWindow& window,
                     fpga::Fidelity fidelity) {
  const platform::BoardConfig board = test::board_config(computer);
  const platform::Tables tables = test::board_tables(computer.board);
  test::RandomPictures pictures(computer.board);
  test::MonitoringBinder binder;
  runs::CameraSimulation simulation(board, tables, pictures,
                                    static_cast<std::uint64_t>(computer.input.frames), binder, fidelity);
  TracedRun run;
  platform::BusTrace trace(board, window, run.records);
  simulation.record_timeline();
  simulation.trace_buses(trace);
  while (!simulation.finished()) {
    for (const runs::Result& result : simulation.advance()) trace.hand_out(result.time_ps);
    for (const platform::TimelineEvent& event : simulation.take_timeline().events) {
      if (event.kind != platform::EventKind::kFrame) continue;
      if (event.what == std::string("strobe")) run.frames.push_back({event.begin_ps, 0});
      run.frames.back().end_ps = event.end_ps;
    }
  }
  run.statistics = simulation.statistics();
  return run;
}

// What of the whole trace of a run at fidelity cycle belongs to a window; or what is wrong with it.
std::string expected_trace(const test::RandomComputer& computer, const CycleWindow& window) {
  const TracedRun run = traced_run(computer, {}, fpga::Fidelity::kCycle);
  const std::string wrong =
      test::differing_lines(plain_part_of(test::run_plain_computer(computer.input)),
                            plain_part_of(run.records)) +
      differing_sums(run.records, test::board_config(computer), *run.statistics.computer);
  if (!wrong.empty()) return wrong + platform::to_yaml(test::board_config(computer));
  TimeRange range;
  if (window.frame) {
    range = run.frames.at(static_cast<std::size_t>(*window.frame));
  } else if (window.last != UINT64_MAX) {
    const test::PlainClock clock(computer.input.board.clock_mhz);
    range = {clock.edge(window.first), clock.edge(window.last + 1)};
  }
  return ':' + text_of(run.records, range);
}

class RandomBusTraces : public testing::TestWithParam<bool> {};

TEST_P(RandomBusTraces, AreTheSameAtEachFidelityAndInThePlainLoopOverEvents) {
  test::RandomKnobs knobs = GetParam() ? test::RandomKnobs::all() : test::RandomKnobs{};
  knobs.large_images = false;
  constexpr std::array kFidelities = {fpga::Fidelity::kCycle, fpga::Fidelity::kFast, fpga::Fidelity::kTiming};
  std::vector<test::ChildWork> jobs;
  const std::uint64_t computers = test::random_computers(40);
  for (std::uint64_t seed = 0; seed < computers; ++seed) {
    jobs.push_back([seed, knobs] {
      const test::RandomComputer computer = test::make_random_computer(seed, knobs);
      return expected_trace(computer, random_window(seed, computer.input));
    });
    for (const fpga::Fidelity fidelity : kFidelities) {
      jobs.push_back([seed, knobs, fidelity] {
        const test::RandomComputer computer = test::make_random_computer(seed, knobs);
        return ':' + text_of(traced_run(computer, random_window(seed, computer.input), fidelity).records);
      });
    }
  }
  const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const std::vector<test::ChildResult> results = test::run_in_children(jobs, processors);
  std::uint64_t empty = 0;
  for (std::size_t seed = 0; seed < computers; ++seed) {
    const std::size_t first = seed * (1 + kFidelities.size());
    const std::string& expected = results[first].text;  // the text is the result
    ASSERT_EQ(results[first].exit_status, 1) << "seed " << seed << ": " << expected;
    ASSERT_EQ(expected.front(), ':') << "seed " << seed << ": " << expected;
    for (std::size_t fidelity = 0; fidelity < kFidelities.size(); ++fidelity) {
      EXPECT_EQ(test::differing_lines(expected, results[first + 1 + fidelity].text), "")
          << "seed " << seed << ", fidelity " << fidelity;
    }
    if (expected == ":") ++empty;
  }
  EXPECT_LT(empty, computers / 4);
}

INSTANTIATE_TEST_SUITE_P(Knobs, RandomBusTraces, testing::Bool(),
                         [](const auto& suite) { return suite.param ? "With" : "Without"; });

}  // namespace
}  // namespace stereotlm::simulation
