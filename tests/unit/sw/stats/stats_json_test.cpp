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

constexpr area::Area kArea = {12'000, 7462, 22.5, 11'900, 5300, 18, 12.5, 36, 25};
constexpr const char* kAreaLine =
    R"(  "area": {"slices": 7462, "slices_percent": 22.5, "luts": 11900, "flip_flops": 5300, )"
    R"("block_rams": 18, "block_rams_percent": 12.5, "multipliers": 36, "multipliers_percent": 25})";

TEST(StatsJson, LeavesOutFiguresThatDoNotExist) {
  platform::Statistics statistics;
  statistics.area = kArea;
  const std::string end = "\n    \"buffers\": []\n  },\n" + std::string(kAreaLine);
  EXPECT_THAT(stats_json(statistics, std::nullopt), EndsWith(end + "\n}\n"));
  EXPECT_THAT(stats_json(statistics, Accuracy{4.25, 2, 81.5}),
              EndsWith(end + ",\n  \"accuracy\": {\"bad_1_percent\": 4.25, \"bad_2_percent\": 2, "
                             "\"answered_percent\": 81.5}\n}\n"));
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
