#include "sw/process/shared_state.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <csignal>
#include <memory>
#include <vector>

#include "sw/process/child_process.h"

namespace stereotlm::process {
namespace {

TEST(SharedState, TellsOtherProcessesToStop) {
  const SharedState state;
  EXPECT_FALSE(state.stop());
  EXPECT_EQ(ChildProcess([&state] {
              state.stop() = true;
              return 0;
            }).wait(),
            0);
  EXPECT_TRUE(state.stop());
}

// Each process adds 1 to the sum that it has read before; without turns, additions would be lost.
TEST(SharedState, LetsOneProcessInAtATime) {
  constexpr int kProcesses = 4;
  constexpr int kTimes = 20000;
  auto* const sum = static_cast<volatile int*>(
      mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  const SharedState state;
  std::vector<std::unique_ptr<ChildProcess>> children(kProcesses);
  for (auto& child : children) {
    child = std::make_unique<ChildProcess>([&] {
      for (int time = 0; time < kTimes; ++time) {
        const SharedState::Turn turn(state);
        *sum = *sum + 1;
      }
      return 0;
    });
  }
  for (const auto& child : children) EXPECT_EQ(child->wait(), 0);
  EXPECT_EQ(*sum, kProcesses * kTimes);
}

TEST(SharedState, LetsTheNextProcessInWhenOneDies) {
  const SharedState state;
  const auto take_turn = [&state](bool dies) {
    const SharedState::Turn turn(state);
    return dies ? raise(SIGKILL) : 0;
  };
  EXPECT_TRUE(WIFSIGNALED(ChildProcess([&] { return take_turn(true); }).wait()));
  EXPECT_EQ(take_turn(false), 0);
  EXPECT_EQ(ChildProcess([&] { return take_turn(false); }).wait(), 0);
}

}  // namespace
}  // namespace stereotlm::process
