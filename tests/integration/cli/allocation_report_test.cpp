#include "sw/cli/allocation_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "platform/config/board_yaml.h"

namespace stereotlm::cli {
namespace {

using explore::AllocationOutcome;
using explore::AllocationSearch;
using platform::BoardConfig;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// An interrupted search of the whole computer, in which each allocation has the bound 20.00001 frames/s.
class InterruptedSearch : public ::testing::Test {
 protected:
  static double bound_of(const BoardConfig& /*board*/) { return 20.00001; }

  AllocationReport report() const {
    AllocationReport report = {search, board, bound_of, "found.db", 8, 99, {"fpl2003"}};
    report.all = search.best();
    report.best = search.best_of_all();
    return report;
  }

  const BoardConfig board = platform::load_board("fpl2003");
  AllocationSearch search{board, 8, {true, 0, ""}, bound_of};
};

TEST_F(InterruptedSearch, HasNoBestBeforeItsFirstResult) {
  EXPECT_THAT(
      allocation_report_text(report()),
      AllOf(HasSubstr("\nInterrupted before an allocation was known.\n"), Not(HasSubstr("stereotlm run"))));
  const nlohmann::ordered_json document = allocation_report_document(report());
  EXPECT_EQ(document["state"], "interrupted");
  EXPECT_FALSE(document.contains("best"));
}

TEST_F(InterruptedSearch, RoundsUpWhatIsPossible) {
  search.record(search.next().front(), AllocationOutcome{1000, 16, 0.5, false, ""});
  EXPECT_THAT(
      allocation_report_text(report()),
      HasSubstr("At most 25.01 % better can exist: no allocation whose rate is unknown has a bound above "
                "20.001 frames/s.\n"));
  EXPECT_EQ(allocation_report_document(report())["best"]["possible_frames_per_second"], 20.00001);
}

TEST_F(InterruptedSearch, NamesTheDatabaseToTryAgainIfItIsKept) {
  search.record(search.next().front(), AllocationOutcome{0, 0, 0, false, "out of luck"});
  AllocationReport kept = report();
  EXPECT_THAT(allocation_report_text(kept),
              HasSubstr(": out of luck\nTo try again:\n  sqlite3 found.db \"DELETE FROM points"));
  kept.store = "";
  EXPECT_THAT(allocation_report_text(kept),
              AllOf(HasSubstr(": out of luck\n"), Not(HasSubstr("To try again"))));
}

TEST_F(InterruptedSearch, MayHaveProvedItsBest) {
  search.record(search.next().front(), AllocationOutcome{1000, 20.00001, 0, false, ""});
  EXPECT_THAT(allocation_report_text(report()),
              HasSubstr("\nNo allocation that uses at most 8 banks gives more.\n"));
  EXPECT_EQ(allocation_report_document(report())["best"]["possible_gain_percent"], 0);
}

}  // namespace
}  // namespace stereotlm::cli
