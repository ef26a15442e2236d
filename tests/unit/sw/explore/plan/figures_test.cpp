#include "sw/explore/plan/figures.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "sw/report/stats_json.h"

namespace stereotlm::explore {
namespace {

using Value = decltype(platform::BoardValue::value);

platform::Statistics statistics() {
  platform::Statistics statistics;
  statistics.board = "fpl2003";
  statistics.fidelity = "fast";
  statistics.frames = 2;
  statistics.cycles = 300;
  statistics.frame_cycles = {100, 200};
  statistics.frames_per_second.core = 18.5;
  statistics.bound = {20.25, "matcher", {}, ""};
  statistics.banks = {{"bank0", 7}, {"b-1", 8}};
  statistics.ports = {{"left_pixel", 5, 3}};
  statistics.blame = {{"left_pixel", "bank0", "host", 2}, {"left_pixel", "bank0", "turnaround", 1}};
  return statistics;
}

std::map<std::string, Value> values_of(const Figures& figures) {
  std::map<std::string, Value> values;
  for (const platform::BoardValue& value : figures.values) {
    EXPECT_TRUE(values.emplace(value.path, value.value).second) << value.path << " twice";
  }
  return values;
}

TEST(Figures, GoByTheirPathsInStatsJson) {
  const auto values = values_of(figures_of(report::stats_document(statistics(), std::nullopt)));
  EXPECT_EQ(values.at("board"), Value("fpl2003"));
  EXPECT_EQ(values.at("cycles"), Value(std::int64_t{300}));
  EXPECT_EQ(values.at("frame_cycles"), Value("[100,200]"));
  EXPECT_EQ(values.at("frames_per_second.core"), Value(18.5));
  EXPECT_EQ(values.at("bound.core_limited_by"), Value("matcher"));
  EXPECT_EQ(values.at("banks.bank0.reads"), Value(std::int64_t{7}));
  EXPECT_EQ(values.at("banks.b-1.reads"), Value(std::int64_t{8}));
  EXPECT_EQ(values.at("ports.left_pixel.stall_cycles"), Value(std::int64_t{3}));
  EXPECT_EQ(values.count("schema"), 0U);
  EXPECT_EQ(values.count("bound.system"), 0U);
}

TEST(Figures, OfTheComputerGoByTheirNamesToo) {
  platform::Statistics whole = statistics();
  whole.computer.emplace();
  whole.computer->pci_clocks = 99;
  whole.computer->pci_masters = {{"host", 4, 5, 6}};
  whole.computer->cameras = {{"left", 10}};
  whole.computer->capture_to_host_ms.p95 = 1.5;
  const auto values = values_of(figures_of(report::stats_document(whole, std::nullopt)));
  EXPECT_EQ(values.at("pci.clocks"), Value(std::int64_t{99}));
  EXPECT_EQ(values.at("pci.masters.host.words"), Value(std::int64_t{5}));
  EXPECT_EQ(values.at("cameras.left.frames"), Value(std::int64_t{10}));
  EXPECT_EQ(values.at("latency_ms.capture_to_host.p95"), Value(1.5));
}

TEST(Figures, KeepBlameInRows) {
  const Figures figures = figures_of(report::stats_document(statistics(), std::nullopt));
  ASSERT_EQ(figures.blame.size(), 2U);
  EXPECT_EQ(figures.blame[1].port, "left_pixel");
  EXPECT_EQ(figures.blame[1].bank, "bank0");
  EXPECT_EQ(figures.blame[1].by, "turnaround");
  EXPECT_EQ(figures.blame[1].cycles, 1);
  EXPECT_EQ(values_of(figures).count("blame"), 0U);
}

}  // namespace
}  // namespace stereotlm::explore
