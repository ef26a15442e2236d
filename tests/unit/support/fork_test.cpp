#include "tests/support/fork.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <thread>

namespace stereotlm::test {
namespace {

using std::chrono::milliseconds;

std::string succeed() { return {}; }

TEST(RunInChild, SucceedsWhenTheWorkReturnsNothing) {
  const auto result = run_in_child(succeed);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.text, "");
}

TEST(RunInChild, FailsWithTheTextThatTheWorkReturns) {
  const auto result = run_in_child([] { return std::string("two lines\nof text"); });
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_EQ(result.text, "two lines\nof text");
}

TEST(RunInChild, HandsBackATextLongerThanAPipeHolds) {
  const std::string text(1'000'000, 'x');
  EXPECT_EQ(run_in_child([&] { return text; }).text, text);
}

TEST(RunInChild, RunsInAnotherProcess) {
  int touched = 0;
  const auto parent = getpid();
  const auto result = run_in_child([&] {
    touched = 1;
    return getpid() == parent ? std::string("same process") : std::string();
  });
  EXPECT_TRUE(result.ok()) << result.text;
  EXPECT_EQ(touched, 0);
}

TEST(RunInChild, FailsWithAnExceptionThatLeavesTheWork) {
  const auto result = run_in_child([]() -> std::string { throw std::runtime_error("no such bank"); });
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.text, "exception: no such bank");
}

TEST(RunInChild, FailsWithAnExpectationThatFailsInTheWork) {
  const auto result = run_in_child([] {
    EXPECT_EQ(1 + 1, 3);
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_NE(result.text.find("fork_test.cpp:"), std::string::npos) << result.text;
  EXPECT_NE(result.text.find("1 + 1"), std::string::npos) << result.text;
}

TEST(RunInChild, NamesTheSignalThatKilledTheChild) {
  const auto result = run_in_child([] {
    std::raise(SIGKILL);
    return std::string();
  });
  EXPECT_EQ(result.exit_status, 128 + SIGKILL);
  EXPECT_EQ(result.text, "killed by signal 9 (Killed)");
}

TEST(RunInChild, IsNotDeceivedByAChildThatExitsEarlyWithStatusZero) {
  const auto result = run_in_child([]() -> std::string { _exit(0); });
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_EQ(result.text, "exited with status 0 before its work returned");
}

TEST(RunInChild, KeepsTheStatusOfAChildThatExitsEarly) {
  const auto result = run_in_child([]() -> std::string { _exit(77); });
  EXPECT_EQ(result.exit_status, 77);
  EXPECT_EQ(result.text, "exited with status 77 before its work returned");
}

TEST(RunInChild, KillsAChildThatRunsOutOfTime) {
  const auto start = std::chrono::steady_clock::now();
  const auto result = run_in_child(
      [] {
        std::this_thread::sleep_for(std::chrono::seconds(50));
        return std::string();
      },
      milliseconds(100));
  EXPECT_EQ(result.exit_status, 124);
  EXPECT_EQ(result.text, "still running after 100 ms");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(RunInChild, LetsAChildFinishThatNeedsLessThanItsTime) {
  const auto result = run_in_child(
      [] {
        std::this_thread::sleep_for(milliseconds(100));
        return std::string();
      },
      std::chrono::seconds(50));
  EXPECT_TRUE(result.ok()) << result.text;
}

TEST(RunInChildren, HandsBackTheResultsInTheOrderOfTheJobs) {
  std::vector<ChildWork> jobs;
  for (int i = 0; i < 20; ++i) {
    jobs.emplace_back([i] {
      std::this_thread::sleep_for(milliseconds(20 - i));
      return i % 3 == 0 ? std::string() : std::to_string(i);
    });
  }
  const auto results = run_in_children(jobs, 4);
  ASSERT_EQ(results.size(), 20U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(results[static_cast<std::size_t>(i)].text, i % 3 == 0 ? "" : std::to_string(i));
  }
}

// Two jobs that each wait for the other's pipe to be written: they end only if both run at once.
TEST(RunInChildren, RunsAsManyAtATimeAsItIsTold) {
  int to_first[2] = {};
  int to_second[2] = {};
  ASSERT_EQ(pipe(to_first), 0);
  ASSERT_EQ(pipe(to_second), 0);
  const auto meet = [](int mine, int other) {
    const char hello = 'h';
    char heard = 0;
    if (write(other, &hello, 1) != 1 || read(mine, &heard, 1) != 1) return std::string("no pipe");
    return std::string();
  };
  const std::vector<ChildWork> jobs = {[&] { return meet(to_first[0], to_second[1]); },
                                       [&] { return meet(to_second[0], to_first[1]); }};
  for (const auto& result : run_in_children(jobs, 2, std::chrono::seconds(30))) EXPECT_EQ(result.text, "");
  for (const int fd : {to_first[0], to_first[1], to_second[0], to_second[1]}) close(fd);
}

TEST(RunInChildren, RunsNoMoreAtATimeThanItIsTold) {
  const std::vector<ChildWork> jobs(4, [] {
    std::this_thread::sleep_for(milliseconds(50));
    return std::string();
  });
  const auto start = std::chrono::steady_clock::now();
  for (const auto& result : run_in_children(jobs, 1)) EXPECT_TRUE(result.ok()) << result.text;
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(200));
}

TEST(RunInChildren, OneFailureLeavesTheOthersAlone) {
  const auto results = run_in_children({succeed, []() -> std::string { _exit(9); }, succeed}, 2);
  EXPECT_TRUE(results[0].ok());
  EXPECT_EQ(results[1].exit_status, 9);
  EXPECT_TRUE(results[2].ok());
}

TEST(RunInChildren, DoesNothingForNoJobs) { EXPECT_TRUE(run_in_children({}, 1).empty()); }

TEST(RunInChildren, RefusesToRunNoneAtATime) {
  EXPECT_THROW(run_in_children({succeed}, 0), std::invalid_argument);
  EXPECT_EQ(run_in_children({succeed}, 1).size(), 1U);
}

}  // namespace
}  // namespace stereotlm::test
