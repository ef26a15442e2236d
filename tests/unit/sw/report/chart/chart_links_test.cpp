#include "sw/report/chart/chart_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "platform/assembly/preloaded_system.h"
#include "platform/config/board_yaml.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "sw/stats/stats_json.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/noise_pairs.h"

namespace stereotlm::report {
namespace {

using platform::BoardConfig;
using platform::load_board;
using platform::Statistics;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> ids(const std::vector<ChartLink>& links) {
  std::vector<std::string> all;
  for (const ChartLink& link : links) all.push_back(link.id());
  return all;
}

ChartLink link_of(const platform::BoardConfig& board, const std::string& id) {
  for (const ChartLink& link : chart_links({board, true})) {
    if (link.id() == id) return link;
  }
  ADD_FAILURE() << id;
  return {};
}

TEST(ChartLinks, OfABoardAloneAreThoseOfItsPorts) {
  EXPECT_THAT(ids(chart_links({load_board("fpl2003")})),
              ElementsAre("edge-left_lut-bank6", "edge-right_lut-bank7", "edge-left_pixel-bank0",
                          "edge-left_pixel-bank1", "edge-right_pixel-bank2", "edge-right_pixel-bank3",
                          "edge-result-bank4", "edge-result-bank5"));
}

TEST(ChartLinks, OfAComputerHaveItsPartsAndTheHostsPortToo) {
  EXPECT_THAT(
      ids(chart_links({load_board("two-banks"), true})),
      ElementsAre("edge-left_camera-left_capture", "edge-right_camera-right_capture", "edge-left_capture-pci",
                  "edge-right_capture-pci", "edge-cpu-pci", "edge-pci-host_memory", "edge-pci-bridge",
                  "edge-bridge-pci", "edge-bridge-local_bus", "edge-local_bus-host", "edge-left_lut-bank0",
                  "edge-left_pixel-bank1", "edge-right_pixel-bank1", "edge-result-bank1", "edge-host-bank0",
                  "edge-host-bank1"));
}

TEST(ChartLinks, LeaveOutWhatABoardDoesNotHave) {
  const auto board = load_board("fpl2003-no-calibration", {"pci.load={burst_words: 8, interval_us: 1}"});
  const std::vector<std::string> all = ids(chart_links({board, true}));
  EXPECT_THAT(all, Contains("edge-load-pci"));
  EXPECT_THAT(all, Not(Contains(HasSubstr("_lut"))));
  EXPECT_THAT(all, Not(Contains(HasSubstr("bank6")))) << "a bank without buffers";
}

TEST(ChartLinks, PointWhereTheWordsGo) {
  const auto board = load_board("fpl2003");
  const auto directions = [&](const std::string& id) {
    const ChartLink link = link_of(board, id);
    return std::string(link.there ? "there" : "") + (link.back ? "back" : "");
  };
  EXPECT_EQ(directions("edge-left_lut-bank6"), "back");
  EXPECT_EQ(directions("edge-left_pixel-bank1"), "back");
  EXPECT_EQ(directions("edge-result-bank4"), "there");
  EXPECT_EQ(directions("edge-host-bank0"), "there");
  EXPECT_EQ(directions("edge-host-bank4"), "back");
  EXPECT_EQ(directions("edge-host-bank6"), "there");
  EXPECT_EQ(directions("edge-left_capture-pci"), "there");
  EXPECT_EQ(directions("edge-bridge-local_bus"), "thereback");
}

TEST(ChartLinks, HaveThePeaksOfTheirClocks) {
  const auto board =
      load_board("fpl2003", {"pci.clock_mhz=66.667", "pci.width_bits=64", "bridge.local_clock_mhz=50",
                             "fpga.clock_mhz=20", "ssram.banks.bank0.kind=qdr"});
  EXPECT_NEAR(link_of(board, "edge-left_camera-left_capture").peak, 12.27, 0.005);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-right_capture-pci").peak, 8 * 66.667);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-local_bus-host").peak, 200);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-left_pixel-bank0").peak, 80) << "a port makes one access a cycle";
}

// The sum over the links with this end.
double sum_of(const std::vector<ChartLink>& links, const std::string& block) {
  double sum = 0;
  for (const ChartLink& link : links) sum += link.from == block || link.to == block ? link.rate : 0;
  return sum;
}

double rate_of(const std::vector<ChartLink>& links, const std::string& id) {
  for (const ChartLink& link : links) {
    if (link.id() == id) return link.rate;
  }
  ADD_FAILURE() << id;
  return 0;
}

void expect_close(double found, double expected, const std::string& what) {
  EXPECT_NEAR(found, expected, 1e-9 * (1 + expected)) << what;
}

// What is written is read again.
void expect_to_read(const Statistics& statistics, const BoardConfig& board) {
  const std::string text = stats::stats_json(statistics, {});
  const bool camera = statistics.computer.has_value();
  EXPECT_EQ(
      stats::stats_json(stats::read_stats(text, board, statistics.fidelity, statistics.frames, camera), {}),
      text);
}

// The links of each bank, port and PCI master have the sums of the statistics.
void expect_sums_of(const Statistics& statistics, const BoardConfig& board) {
  expect_to_read(statistics, board);
  const std::vector<ChartLink> links = chart_links({board, statistics.computer.has_value(), &statistics});
  for (const platform::BankStatistics& bank : statistics.banks) {
    expect_close(sum_of(links, "bank-" + bank.name), bank.megabytes_per_second, bank.name);
  }
  const double cycles = static_cast<double>(statistics.cycles);
  for (const platform::PortStatistics& port : statistics.ports) {
    double sum = sum_of(links, "port-" + port.name);
    if (statistics.computer && port.name == "host") sum -= rate_of(links, "edge-local_bus-host");
    expect_close(sum, 4 * static_cast<double>(port.grants) * board.fpga.clock_mhz / cycles, port.name);
  }
  if (!statistics.computer) return;
  const platform::ComputerStatistics& around = *statistics.computer;
  const double us = static_cast<double>(around.pci_clocks) / board.pci.clock_mhz;
  const bool to_host = board.capture.destination == platform::CaptureDestination::kHostMemory;
  std::uint64_t of_host_memory = 0;
  const std::map<std::string, std::string> ids = {{"host", "edge-cpu-pci"},
                                                  {"left_capture", "edge-left_capture-pci"},
                                                  {"right_capture", "edge-right_capture-pci"},
                                                  {"bridge", "edge-bridge-pci"},
                                                  {"load", "edge-load-pci"}};
  for (const platform::PciMasterStatistics& master : around.pci_masters) {
    expect_close(rate_of(links, ids.at(master.name)), 4 * static_cast<double>(master.words) / us,
                 master.name);
    const bool is_capture = master.name == "left_capture" || master.name == "right_capture";
    if (master.name == "bridge" || (to_host && is_capture)) of_host_memory += master.words;
  }
  expect_close(rate_of(links, "edge-pci-host_memory"), 4 * static_cast<double>(of_host_memory) / us,
               "host memory");
  expect_close(rate_of(links, "edge-pci-bridge"), 4 * static_cast<double>(around.posted_words) / us,
               "posted");
}

TEST(ChartTraffic, OfRandomBoardsHasTheSumsOfTheirStatistics) {
  test::RandomKnobs knobs = test::RandomKnobs::all();
  knobs.large_images = false;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const test::RandomBoard random = test::make_random_board(seed, knobs);
    SCOPED_TRACE(test::describe(random));
    const BoardConfig board = test::board_config(random);
    const auto frames = static_cast<std::uint64_t>(random.frames);
    expect_sums_of(platform::run_core(board, test::board_tables(random), frames), board);
  }
}

TEST(ChartTraffic, OfRandomComputersHasTheSumsOfTheirStatistics) {
  test::RandomKnobs knobs = test::RandomKnobs::all();
  knobs.large_images = false;
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    jobs.emplace_back([seed, knobs] {
      const test::RandomComputer random = test::make_random_computer(seed, knobs);
      SCOPED_TRACE(test::describe(random.board));
      const BoardConfig board = test::board_config(random);
      const platform::Tables tables = test::board_tables(random.board);
      test::NoisePairs pairs(board.image.width, board.image.height);
      Binder binder;
      runs::CameraSimulation simulation(board, tables, pairs, static_cast<std::uint64_t>(random.input.frames),
                                        binder, fpga::Fidelity::kTiming);
      while (!simulation.finished()) simulation.advance();
      expect_sums_of(simulation.statistics(), board);
      return std::string();
    });
  }
  for (const test::ChildResult& result : test::run_in_children(jobs, 2))
    EXPECT_TRUE(result.ok()) << result.text;
}

}  // namespace
}  // namespace stereotlm::report
