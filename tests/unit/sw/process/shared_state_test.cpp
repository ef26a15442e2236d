#include "sw/process/shared_state.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <vector>

namespace stereotlm::process {
namespace {

template <typename Work>
pid_t in_child(const Work& work) {
  const pid_t pid = fork();
  if (pid == 0) {
    work();
    _exit(0);
  }
  return pid;
}

int end_of(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return status;
}

TEST(SharedState, TellsOtherProcessesToStop) {
  const SharedState state;
  EXPECT_FALSE(state.stop());
  EXPECT_EQ(end_of(in_child([&state] { state.stop() = true; })), 0);
  EXPECT_TRUE(state.stop());
}

// Each adds 1 to what it has read before; without turns sums are lost.
TEST(SharedState, LetsOneProcessInAtATime) {
  constexpr int kProcesses = 4;
  constexpr int kTimes = 20000;
  auto* const sum = static_cast<volatile int*>(
      mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  const SharedState state;
  std::vector<pid_t> children;
  for (int process = 0; process < kProcesses; ++process) {
    children.push_back(in_child([&] {
      for (int time = 0; time < kTimes; ++time) {
        const SharedState::Turn turn(state);
        *sum = *sum + 1;
      }
    }));
  }
  for (const pid_t child : children) EXPECT_EQ(end_of(child), 0);
  EXPECT_EQ(*sum, kProcesses * kTimes);
}

TEST(SharedState, LetsTheNextOneInWhenAProcessDies) {
  const SharedState state;
  const pid_t child = in_child([&state] {
    const SharedState::Turn turn(state);
    raise(SIGKILL);
  });
  EXPECT_TRUE(WIFSIGNALED(end_of(child)));
  { const SharedState::Turn turn(state); }
  EXPECT_EQ(end_of(in_child([&state] { const SharedState::Turn turn(state); })), 0);
}

}  // namespace
}  // namespace stereotlm::process
