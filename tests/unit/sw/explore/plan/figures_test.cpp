#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "sw/explore/store/store.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::explore {
namespace {

using Value = decltype(platform::BoardValue::value);

platform::Statistics statistics() {
  platform::Statistics statistics;
  statistics.board = "fpl2003";
  statistics.fidelity = "fast";
  statistics.cycles = 300;
  statistics.frame_cycles = {100, 200};
  statistics.frames_per_second.core = 18.5;
  statistics.bound = {20.25, "matcher", {}, ""};
  statistics.banks = {{"bank0", 7}, {"b-1", 8}};
  statistics.ports = {{"left_pixel", 5, 3}};
  statistics.blame = {{"left_pixel", "bank0", "host", 2}, {"left_pixel", "bank0", "turnaround", 1}};
  statistics.computer.emplace();
  statistics.computer->pci_clocks = 99;
  statistics.computer->pci_masters = {{"host", 4, 5, 6}};
  statistics.computer->cameras = {{"left", 10}};
  statistics.computer->capture_to_host_ms.p95 = 1.5;
  return statistics;
}

TEST(Figures, HaveTheDottedPathsOfStatsJsonAndRowsOfBlame) {
  const Figures figures = figures_of(stats::stats_document(statistics(), std::nullopt));
  std::map<std::string, Value> values;
  for (const platform::BoardValue& value : figures.values)
    EXPECT_TRUE(values.emplace(value.path, value.value).second) << value.path << " twice";
  const std::map<std::string, Value> expected = {{"board", "fpl2003"},
                                                 {"cycles", std::int64_t{300}},
                                                 {"frame_cycles", "[100,200]"},
                                                 {"frames_per_second.core", 18.5},
                                                 {"bound.core_limited_by", "matcher"},
                                                 {"banks.bank0.reads", std::int64_t{7}},
                                                 {"banks.b-1.reads", std::int64_t{8}},
                                                 {"ports.left_pixel.stall_cycles", std::int64_t{3}},
                                                 {"pci.clocks", std::int64_t{99}},
                                                 {"pci.masters.host.words", std::int64_t{5}},
                                                 {"cameras.left.frames", std::int64_t{10}},
                                                 {"latency_ms.capture_to_host.p95", 1.5}};
  for (const auto& [path, value] : expected) EXPECT_EQ(values.at(path), value) << path;
  for (const char* const absent : {"schema", "blame", "bound.system"}) EXPECT_EQ(values.count(absent), 0U);
  ASSERT_EQ(figures.blame.size(), 2U);
  EXPECT_EQ(figures.blame[1].port, "left_pixel");
  EXPECT_EQ(figures.blame[1].bank, "bank0");
  EXPECT_EQ(figures.blame[1].by, "turnaround");
  EXPECT_EQ(figures.blame[1].cycles, 1);
}

}  // namespace
}  // namespace stereotlm::explore
