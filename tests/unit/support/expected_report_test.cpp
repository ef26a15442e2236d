#include "tests/support/expected_report.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <systemc>

#include "tests/support/fork.h"

namespace stereotlm::test {
namespace {

constexpr const char* kType = "/stereotlm/test";

TEST(SystemcTestMain, FailsATestWithAnUnannouncedWarning) {
  EXPECT_NONFATAL_FAILURE(SC_REPORT_WARNING(kType, "too hot"), "did not announce");
}

TEST(SystemcTestMain, FailsATestWithAnUnannouncedErrorAndStillThrowsIt) {
  EXPECT_NONFATAL_FAILURE(EXPECT_THROW(SC_REPORT_ERROR(kType, "broken"), sc_core::sc_report), "broken");
}

TEST(SystemcTestMain, SaysWhereAnUnannouncedReportWasMade) {
  testing::TestPartResultArray parts;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &parts);
    SC_REPORT_WARNING(kType, "too hot");
  }
  ASSERT_EQ(parts.size(), 1);
  EXPECT_STREQ(parts.GetTestPartResult(0).file_name(), __FILE__);
}

TEST(SystemcTestMain, FailsATestWithAWarningOfTheKernelItself) {
  const sc_core::sc_signal<bool> first("twin");
  EXPECT_NONFATAL_FAILURE(sc_core::sc_signal<bool>("twin"), "already exists");
}

TEST(SystemcTestMain, AFatalReportStillAborts) {
  const auto result = run_in_child([] {
    SC_REPORT_FATAL(kType, "gone");
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 128 + SIGABRT) << result.text;
}

TEST(SystemcTestMain, IgnoresInfoReports) { SC_REPORT_INFO(kType, "nothing to see"); }

TEST(SystemcTestMain, PrintsNoCopyrightBanner) {
  EXPECT_STREQ(std::getenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE"), "1");
}

TEST(ExpectedReport, LetsAnAnnouncedWarningPassAndKeepsItsText) {
  const ExpectedReport expected(kType);
  EXPECT_EQ(expected.text(), "");
  SC_REPORT_WARNING(kType, "too hot");
  EXPECT_EQ(expected.text(), "too hot");
}

TEST(ExpectedReport, LeavesAnAnnouncedErrorItsException) {
  const ExpectedReport expected(kType);
  EXPECT_THROW(SC_REPORT_ERROR(kType, "broken"), sc_core::sc_report);
}

TEST(ExpectedReport, FailsWhenTheReportDoesNotCome) {
  EXPECT_NONFATAL_FAILURE(ExpectedReport expected(kType), "did not come: 1 missing");
}

TEST(ExpectedReport, DoesNotStandForAnotherType) {
  const ExpectedReport expected(kType);
  EXPECT_NONFATAL_FAILURE(SC_REPORT_WARNING("/stereotlm/other", "too hot"), "did not announce");
  SC_REPORT_WARNING(kType, "too hot");
}

TEST(ExpectedReport, StandsForNoMoreThanItsCount) {
  const ExpectedReport expected(kType, 2);
  SC_REPORT_WARNING(kType, "one");
  SC_REPORT_WARNING(kType, "two");
  EXPECT_NONFATAL_FAILURE(SC_REPORT_WARNING(kType, "three"), "did not announce");
}

TEST(ExpectedReport, FailsWhenFewerComeThanAnnounced) {
  auto expected = std::make_unique<ExpectedReport>(kType, 3);
  SC_REPORT_WARNING(kType, "one");
  EXPECT_NONFATAL_FAILURE(expected.reset(), "2 missing");
}

TEST(ExpectedReport, ASecondAnnouncementTakesTheSecondReport) {
  const ExpectedReport first(kType);
  const ExpectedReport second(kType);
  SC_REPORT_WARNING(kType, "one");
  SC_REPORT_WARNING(kType, "two");
  EXPECT_EQ(first.text(), "one");
  EXPECT_EQ(second.text(), "two");
}

TEST(ExpectedReport, EndsWithItsScope) {
  {
    const ExpectedReport expected(kType);
    SC_REPORT_WARNING(kType, "inside");
  }
  EXPECT_NONFATAL_FAILURE(SC_REPORT_WARNING(kType, "outside"), "did not announce");
}

}  // namespace
}  // namespace stereotlm::test
