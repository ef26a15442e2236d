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

void warn(const char* text = "too hot", const char* type = kType) { SC_REPORT_WARNING(type, text); }

TEST(SystemcTestMain, FailsATestThatDidNotAnnounceAWarningAndSaysWhereItWasMade) {
  testing::TestPartResultArray parts;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &parts);
    warn();
  }
  ASSERT_EQ(parts.size(), 1);
  EXPECT_TRUE(parts.GetTestPartResult(0).nonfatally_failed());
  EXPECT_STREQ(parts.GetTestPartResult(0).file_name(), __FILE__);
}

TEST(SystemcTestMain, FailsATestThatDidNotAnnounceAnErrorAndStillThrowsIt) {
  EXPECT_NONFATAL_FAILURE(EXPECT_THROW(SC_REPORT_ERROR(kType, "broken"), sc_core::sc_report), "broken");
}

TEST(SystemcTestMain, FailsATestWithAWarningOfTheKernelItself) {
  const sc_core::sc_signal<bool> first("twin");
  EXPECT_NONFATAL_FAILURE(sc_core::sc_signal<bool>("twin"), "already exists");
}

TEST(SystemcTestMain, LeavesAFatalReportItsAbort) {
  const auto result = run_in_child([] {
    SC_REPORT_FATAL(kType, "gone");
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 128 + SIGABRT) << result.text;
}

TEST(SystemcTestMain, IgnoresInfoReports) { SC_REPORT_INFO(kType, "nothing to see"); }

TEST(ExpectedReport, LetsAsManyReportsPassAsItAnnouncesAndKeepsTheLastText) {
  const ExpectedReport expected(kType, 2);
  EXPECT_EQ(expected.text(), "");
  warn("one");
  warn("two");
  EXPECT_EQ(expected.text(), "two");
  EXPECT_NONFATAL_FAILURE(warn("three"), "did not announce");
}

TEST(ExpectedReport, FailsWhenFewerReportsComeThanItAnnounces) {
  auto expected = std::make_unique<ExpectedReport>(kType, 3);
  warn();
  EXPECT_NONFATAL_FAILURE(expected.reset(), "did not come: 2 missing");
}

TEST(ExpectedReport, DoesNotStandForAnotherType) {
  const ExpectedReport expected(kType);
  EXPECT_NONFATAL_FAILURE(warn("too hot", "/stereotlm/other"), "did not announce");
  warn();
}

TEST(ExpectedReport, TakesItsReportAfterAnEarlierAnnouncementHasTakenOne) {
  const ExpectedReport first(kType);
  const ExpectedReport second(kType);
  warn("one");
  warn("two");
  EXPECT_EQ(first.text(), "one");
  EXPECT_EQ(second.text(), "two");
}

}  // namespace
}  // namespace stereotlm::test
