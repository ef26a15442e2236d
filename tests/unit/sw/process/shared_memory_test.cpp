#include "sw/process/shared_memory.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <memory>
#include <vector>

#include "sw/process/child.h"

namespace stereotlm::process {
namespace {

TEST(SharedMemory, ShowsWhatAnotherProcessHasWritten) {
  const SharedMemory memory(sizeof(int));
  const auto* const value = static_cast<const int*>(memory.data());
  EXPECT_EQ(*value, 0);
  ChildProcess child([&memory] {
    *static_cast<int*>(memory.data()) = 7;
    return 0;
  });
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(*value, 7);
}

// Each process adds 1 to the sum that it has read before; without turns, additions would be lost.
TEST(SharedLock, LetsOneProcessInAtATime) {
  constexpr int kProcesses = 4;
  constexpr int kTimes = 20000;
  const SharedMemory memory(sizeof(int));
  auto* const sum = static_cast<volatile int*>(memory.data());
  const SharedLock lock;
  std::vector<std::unique_ptr<ChildProcess>> children(kProcesses);
  for (auto& child : children) {
    child = std::make_unique<ChildProcess>([&] {
      for (int time = 0; time < kTimes; ++time) {
        const SharedLock::Turn turn(lock);
        *sum = *sum + 1;
      }
      return 0;
    });
  }
  for (const auto& child : children) EXPECT_EQ(child->wait(), 0);
  EXPECT_EQ(*sum, kProcesses * kTimes);
}

TEST(SharedLock, LetsTheNextProcessInWhenOneDies) {
  const SharedLock lock;
  const auto take_turn = [&lock](bool dies) {
    const SharedLock::Turn turn(lock);
    return dies ? raise(SIGKILL) : 0;
  };
  EXPECT_TRUE(WIFSIGNALED(ChildProcess([&] { return take_turn(true); }).wait()));
  EXPECT_EQ(take_turn(false), 0);
  EXPECT_EQ(ChildProcess([&] { return take_turn(false); }).wait(), 0);
}

}  // namespace
}  // namespace stereotlm::process
