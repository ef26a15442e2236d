// What makes a test fail: a SystemC report that it did not announce, a broken rule of the protocol that it
// did not expect, and a child process that fails. If these failed no longer, no other test would notice.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <stdexcept>
#include <string>
#include <systemc>
#include <thread>
#include <vector>

#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/fork.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::test {
namespace {

constexpr const char* kType = "/stereotlm/test";

void warn(const char* type = kType) { SC_REPORT_WARNING(type, "too hot"); }

TEST(SystemcTestMain, FailsATestWithAReportThatItDidNotAnnounce) {
  EXPECT_NONFATAL_FAILURE(warn(), "did not announce");
  EXPECT_NONFATAL_FAILURE(EXPECT_THROW(SC_REPORT_ERROR(kType, "broken"), sc_core::sc_report), "broken");
  SC_REPORT_INFO(kType, "nothing to see");
}

TEST(ExpectedReport, CoversAsManyReportsOfItsTypeAsItAnnouncesAndFailsWithFewer) {
  auto expected = std::make_unique<ExpectedReport>(kType, 2);
  EXPECT_NONFATAL_FAILURE(warn("/stereotlm/other"), "did not announce");
  warn();
  EXPECT_EQ(expected->text(), "too hot");
  EXPECT_NONFATAL_FAILURE(expected.reset(), "did not come: 1 missing");
  EXPECT_NONFATAL_FAILURE(warn(), "did not announce");
}

// The tests of the modules expect violations, and show that correct calls have none.
TEST(MonitoringBinder, FailsTheTestWithAViolationThatNobodyTook) {
  auto binder = std::make_unique<MonitoringBinder>();
  TestHost host("host");
  ScriptedTarget target("target");
  binder->bind(host.socket, target.socket, "link");
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  host.read(0x42);
  EXPECT_NONFATAL_FAILURE(binder.reset(), "link_monitor at 0 s: b_transport: address = 0x42");
}

TEST(RunInChild, GivesTheStatusAndTheTextOfEachEnding) {
  struct Ending {
    ChildWork work;
    int exit_status;
    std::string text;
  };
  const std::string more_than_a_pipe_holds(1'000'000, 'x');
  const Ending endings[] = {
      {[] { return std::string(); }, 0, ""},
      {[&] { return more_than_a_pipe_holds; }, 1, more_than_a_pipe_holds},
      {[]() -> std::string { throw std::runtime_error("no such bank"); }, 2, "exception: no such bank"},
      {[]() -> std::string { return std::to_string(std::raise(SIGKILL)); }, 128 + SIGKILL,
       "killed by signal 9 (Killed)"},
      {[]() -> std::string { _exit(0); }, 1, "exited with status 0 before its work returned"},
      {[] {
         std::this_thread::sleep_for(std::chrono::seconds(50));
         return std::string();
       },
       124, "still running after 500 ms"},
  };
  for (const Ending& ending : endings) {
    const ChildResult result = run_in_child(ending.work, std::chrono::milliseconds(500));
    EXPECT_EQ(result.exit_status, ending.exit_status);
    EXPECT_EQ(result.text, ending.text);
  }
}

TEST(RunInChild, BeginsNoFurtherWorkOnceOneRanOutOfTime) {
  const ChildWork endless = []() -> std::string {
    while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
  };
  const std::vector<ChildWork> jobs = {[] { return "a"; }, endless, [] { return "b"; }, endless};
  const std::vector<ChildResult> results = run_in_children(jobs, 1, std::chrono::milliseconds(200));
  EXPECT_EQ(results[0].text, "a");
  EXPECT_EQ(results[1].text, "still running after 200 ms");
  for (const std::size_t job : {2U, 3U}) {
    EXPECT_EQ(results[job].exit_status, 124);
    EXPECT_EQ(results[job].text, "not begun, because another ran out of time");
  }
}

TEST(RunInChild, FailsWithAnExpectationThatFailsInTheWork) {
  const ChildResult result = run_in_child([] {
    EXPECT_EQ(1 + 1, 3);
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_NE(result.text.find("1 + 1"), std::string::npos) << result.text;
}

}  // namespace
}  // namespace stereotlm::test
