#include "sw/report/stats_differences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace stereotlm::report {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> differences(const std::string& first, const std::string& second) {
  return stats_differences(first, second, "fast", "cycle");
}

TEST(StatsDifferences, FindsNoneInTheSameValues) {
  EXPECT_THAT(differences(R"({"a": 1, "b": [1.5, "x"]})", R"({ "b": [1.5, "x"], "a": 1 })"), IsEmpty());
  EXPECT_THAT(differences("{}", "{}"), IsEmpty());
}

TEST(StatsDifferences, NamesEachValueByItsPathInOneLine) {
  EXPECT_THAT(
      differences(R"({"banks": [{"reads": 5, "name": "bank0"}], "frames": 1})",
                  R"({"banks": [{"reads": 6, "name": "bank1"}], "frames": 1})"),
      ElementsAre(R"(/banks/0/name: fast "bank0", cycle "bank1")", "/banks/0/reads: fast 5, cycle 6"));
}

TEST(StatsDifferences, ReportsAMissingValueAsAbsent) {
  EXPECT_THAT(differences(R"({"a": 1, "b": 2})", R"({"b": 2, "c": 3})"),
              ElementsAre("/a: fast 1, cycle absent", "/c: fast absent, cycle 3"));
  EXPECT_THAT(differences(R"({"list": [1, 2]})", R"({"list": [1]})"),
              ElementsAre("/list/1: fast 2, cycle absent"));
}

TEST(StatsDifferences, ComparesNumbersToTheLastDigit) {
  EXPECT_THAT(differences(R"({"rate": 18.600000000000001})", R"({"rate": 18.600000000000005})").size(), 1U);
}

TEST(StatsDifferences, RefusesWhatIsNotJson) {
  EXPECT_THROW(differences("{", "{}"), std::runtime_error);
  EXPECT_THROW(differences("{}", "nothing"), std::runtime_error);
}

}  // namespace
}  // namespace stereotlm::report
