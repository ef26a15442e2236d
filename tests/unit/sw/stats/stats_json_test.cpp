#include "sw/stats/stats_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::stats {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

platform::Statistics small_run() {
  platform::Statistics statistics;
  statistics.board = "small";
  statistics.fidelity = "cycle";
  statistics.frames = 2;
  statistics.cycles = 2000;
  statistics.frame_cycles = {1016, 1016};
  statistics.frames_per_second.core = 18.6;
  statistics.bound.core = 19.25;
  statistics.bound.core_limited_by = "left_pixel";
  statistics.banks = {{"bank0", 1500, 20, 1520, 7, 473, 3, 0.76, 121.6}};
  statistics.ports = {{"left_lut", 1, 2, 3, 4, 5, 6}, {"host", 0, 0, 0, 2000, 0, 0}};
  statistics.blame = {{"left_lut", "bank0", "left_pixel", 40}};
  statistics.area = {12'000, 7462, 22.5, 11'900, 5300, 18, 12.5, 36, 25};
  return statistics;
}

// The line of small_run().
constexpr const char* kArea =
    R"(  "area": {"slices": 7462, "slices_percent": 22.5, "luts": 11900, "flip_flops": 5300, )"
    R"("block_rams": 18, "block_rams_percent": 12.5, "multipliers": 36, "multipliers_percent": 25})";

TEST(StatsJson, HasTheKeysOfTheContractInTheirOrder) {
  EXPECT_EQ(stats_json(small_run(), Accuracy{4.25, 2, 81.5}),
            R"({
  "schema": 1,
  "board": "small",
  "fidelity": "cycle",
  "frames": 2,
  "cycles": 2000,
  "frame_cycles": [1016, 1016],
  "frames_per_second": {"core": 18.6},
  "bound": {"core": 19.25, "core_limited_by": "left_pixel"},
  "banks": [
    {"name": "bank0", "reads": 1500, "writes": 20, "busy_cycles": 1520, "turnaround_cycles": 7, )"
            R"("idle_cycles": 473, "contended_cycles": 3, "utilization": 0.76, "megabytes_per_second": 121.6}
  ],
  "ports": [
    {"name": "left_lut", "grants": 1, "stall_cycles": 2, "passed_cycles": 3, "idle_cycles": 4, )"
            R"("blocked_cycles": 5, "starved_cycles": 6},
    {"name": "host", "grants": 0, "stall_cycles": 0, "passed_cycles": 0, "idle_cycles": 2000, )"
            R"("blocked_cycles": 0, "starved_cycles": 0}
  ],
  "blame": [
    {"port": "left_lut", "bank": "bank0", "by": "left_pixel", "cycles": 40}
  ],
)" + std::string(kArea) +
                R"(,
  "accuracy": {"bad_1_percent": 4.25, "bad_2_percent": 2, "answered_percent": 81.5}
}
)");
}

TEST(StatsJson, HasTheKeysOfAComputer) {
  platform::Statistics statistics = small_run();
  statistics.frames_per_second.system = 17.5;
  statistics.frames_per_second.steady = {17.75, 0.5, 12};
  statistics.bound.system = 18.5;
  statistics.bound.system_limited_by = "pci";
  platform::ComputerStatistics& computer = statistics.computer.emplace();
  computer.pci_clocks = 1000;
  computer.pci_busy_clocks = 400;
  computer.pci_masters = {{"host", 1, 2, 3}, {"bridge", 4, 5, 6}};
  computer.posted_words = 7;
  computer.dma_words = 8;
  computer.local_clocks = 1200;
  computer.local_busy_clocks = 9;
  computer.cameras = {{"left", 10, 6, 4, 80, 3, 1, 0}};
  computer.capture_to_host_ms = {77.5, 80, 90.25, 99, 100};
  const std::string text = stats_json(statistics, std::nullopt);
  EXPECT_THAT(text, HasSubstr(R"(
  "frames_per_second": {"core": 18.6, "system": 17.5, "steady": 17.75, "steady_uncertainty": 0.5},
  "bound": {"core": 19.25, "core_limited_by": "left_pixel", "system": 18.5, "system_limited_by": "pci"},
)"));
  EXPECT_THAT(text, HasSubstr(R"(
  "pci": {
    "clocks": 1000,
    "busy_clocks": 400,
    "masters": [
      {"name": "host", "transactions": 1, "words": 2, "wait_clocks": 3},
      {"name": "bridge", "transactions": 4, "words": 5, "wait_clocks": 6}
    ]
  },
  "bridge": {"posted_words": 7, "dma_words": 8, "local_clocks": 1200, "local_busy_clocks": 9},
  "cameras": [
    {"name": "left", "frames": 10, "captured_frames": 6, "dropped_frames": 4, "dropped_pixels": 80, )"
                              R"("dropped_not_armed": 3, "dropped_busy": 1, "dropped_by_partner": 0}
  ],
  "latency_ms": {
    "capture_to_host": {"min": 77.5, "p50": 80, "p95": 90.25, "p99": 99, "max": 100}
  },
)" + std::string(kArea) + "\n}\n"));
}

TEST(StatsJson, LeavesOutFiguresThatDoNotExist) {
  platform::Statistics statistics = small_run();
  statistics.blame.clear();
  const std::string end = "  \"blame\": [],\n" + std::string(kArea);
  EXPECT_THAT(stats_json(statistics, std::nullopt), EndsWith(end + "\n}\n"));
  EXPECT_THAT(stats_json(statistics, Accuracy{std::nullopt, std::nullopt, 0}),
              EndsWith(end + ",\n  \"accuracy\": {\"answered_percent\": 0}\n}\n"));
  EXPECT_THAT(stats_json(statistics, Accuracy{}), EndsWith(end + ",\n  \"accuracy\": {}\n}\n"));
  statistics.failed = {"bank0: 1 + 2 = 3, not 4"};
  EXPECT_THAT(stats_json(statistics, std::nullopt),
              EndsWith(end + ",\n  \"failed\": [\"bank0: 1 + 2 = 3, not 4\"]\n}\n"));
}

std::vector<std::string> differences(const std::string& first, const std::string& second) {
  return stats_differences(first, second, "fast", "cycle");
}

TEST(StatsDifferences, NameEachValueByItsPathInOneLine) {
  struct Case {
    const char* fast;
    const char* cycle;
    std::vector<std::string> lines;
  };
  const std::vector<Case> cases = {
      {"{}", "{}", {}},
      {R"({"a": 1, "b": [1.5, "x"]})", R"({ "b": [1.5, "x"], "a": 1 })", {}},
      {R"({"banks": [{"reads": 5, "name": "bank0"}], "frames": 1})",
       R"({"banks": [{"reads": 6, "name": "bank1"}], "frames": 1})",
       {R"(/banks/0/name: fast "bank0", cycle "bank1")", "/banks/0/reads: fast 5, cycle 6"}},
      {R"({"a": 1, "b": 2})",
       R"({"b": 2, "c": 3})",
       {"/a: fast 1, cycle absent", "/c: fast absent, cycle 3"}},
      {R"({"list": [1, 2]})", R"({"list": [1]})", {"/list/1: fast 2, cycle absent"}},
      {R"({"rate": 1.0})", R"({"rate": 1.0000000000000002})", {"/rate: fast 1.0, cycle 1.0000000000000002"}}};
  for (const Case& one : cases) EXPECT_EQ(differences(one.fast, one.cycle), one.lines);
}

TEST(StatsDifferences, RefusesWhatIsNotJson) {
  EXPECT_THROW(differences("{", "{}"), std::runtime_error);
  EXPECT_THROW(differences("{}", "nothing"), std::runtime_error);
}

}  // namespace
}  // namespace stereotlm::stats
