#include "sw/stats/stats_differences.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::stats {
namespace {

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
