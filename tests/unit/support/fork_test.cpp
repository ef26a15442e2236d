#include "tests/support/fork.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <ostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace stereotlm::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::string succeed() { return {}; }

ChildWork sleep_for(milliseconds time) {
  return [time] {
    std::this_thread::sleep_for(time);
    return std::string();
  };
}

struct Ending {
  const char* name;
  ChildWork work;
  int exit_status;
  std::string text;
  friend void PrintTo(const Ending& ending, std::ostream* out) { *out << ending.name; }
};

class RunInChildEnding : public testing::TestWithParam<Ending> {};

TEST_P(RunInChildEnding, HasItsStatusAndText) {
  const ChildResult result = run_in_child(GetParam().work);
  EXPECT_EQ(result.exit_status, GetParam().exit_status);
  EXPECT_EQ(result.text, GetParam().text);
  EXPECT_EQ(result.ok(), GetParam().exit_status == 0);
}

const std::string kMoreThanAPipeHolds(1'000'000, 'x');

INSTANTIATE_TEST_SUITE_P(
    Of, RunInChildEnding,
    testing::Values(Ending{"Success", succeed, 0, ""},
                    Ending{"Text", [] { return std::string("two lines\nof text"); }, 1, "two lines\nof text"},
                    Ending{"LongText", [] { return kMoreThanAPipeHolds; }, 1, kMoreThanAPipeHolds},
                    Ending{"Exception", []() -> std::string { throw std::runtime_error("no such bank"); }, 2,
                           "exception: no such bank"},
                    Ending{"Signal",
                           [] {
                             std::raise(SIGKILL);
                             return std::string();
                           },
                           128 + SIGKILL, "killed by signal 9 (Killed)"},
                    Ending{"EarlyExitWithZero", []() -> std::string { _exit(0); }, 1,
                           "exited with status 0 before its work returned"},
                    Ending{"EarlyExit", []() -> std::string { _exit(77); }, 77,
                           "exited with status 77 before its work returned"}),
    [](const auto& ending) { return ending.param.name; });

TEST(RunInChild, FailsWithAnExpectationThatFailsInTheWork) {
  const auto result = run_in_child([] {
    EXPECT_EQ(1 + 1, 3);
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_NE(result.text.find("fork_test.cpp:"), std::string::npos) << result.text;
  EXPECT_NE(result.text.find("1 + 1"), std::string::npos) << result.text;
}

TEST(RunInChild, KillsAChildThatRunsOutOfTime) {
  const auto start = std::chrono::steady_clock::now();
  const auto result = run_in_child(sleep_for(seconds(50)), milliseconds(100));
  EXPECT_EQ(result.exit_status, 124);
  EXPECT_EQ(result.text, "still running after 100 ms");
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(20));
  EXPECT_TRUE(run_in_child(sleep_for(milliseconds(100)), seconds(50)).ok());
}

TEST(RunInChildren, RunsNoMoreAtATimeThanItIsTold) {
  const auto start = std::chrono::steady_clock::now();
  run_in_children(std::vector<ChildWork>(4, sleep_for(milliseconds(50))), 1);
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(200));
}

TEST(RunInChildren, RefusesToRunNoneAtATime) {
  EXPECT_THROW(run_in_children({succeed}, 0), std::invalid_argument);
  EXPECT_TRUE(run_in_children({}, 1).empty());
}

}  // namespace
}  // namespace stereotlm::test
