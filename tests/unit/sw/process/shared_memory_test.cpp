#include "sw/process/shared_memory.h"

#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <optional>
#include <vector>

#include "sw/process/child.h"

namespace stereotlm::process {
namespace {

TEST(SharedMemory, ShowsWhatAnotherProcessHasWritten) {
  const SharedMemory memory(sizeof(int));
  const auto* const value = static_cast<const int*>(memory.data());
  EXPECT_EQ(*value, 0);
  Child child([&memory](const Child::Tell& /*tell*/) { *static_cast<int*>(memory.data()) = 7; });
  EXPECT_EQ(child.next(), std::nullopt);
  EXPECT_EQ(*value, 7);
}

// Each process adds 1 to the sum that it has read before; without turns, additions would be lost.
TEST(SharedLock, LetsOneProcessInAtATime) {
  constexpr int kProcesses = 4;
  constexpr int kTimes = 20000;
  const SharedMemory memory(sizeof(int));
  auto* const sum = static_cast<volatile int*>(memory.data());
  const SharedLock lock;
  std::vector<std::unique_ptr<Child>> children(kProcesses);
  for (auto& child : children) {
    child = std::make_unique<Child>([&](const Child::Tell& /*tell*/) {
      for (int time = 0; time < kTimes; ++time) {
        const SharedLock::Turn turn(lock);
        *sum = *sum + 1;
      }
    });
  }
  for (const auto& child : children) EXPECT_EQ(child->next(), std::nullopt);
  EXPECT_EQ(*sum, kProcesses * kTimes);
}

TEST(SharedLock, LetsTheNextProcessInWhenOneDies) {
  const SharedLock lock;
  const auto take_turn = [&lock](bool dies) {
    const SharedLock::Turn turn(lock);
    if (dies) raise(SIGKILL);
  };
  EXPECT_THROW(Child([&](const Child::Tell& /*tell*/) { take_turn(true); }).next(), ChildDied);
  take_turn(false);
  EXPECT_EQ(Child([&](const Child::Tell& /*tell*/) { take_turn(false); }).next(), std::nullopt);
}

}  // namespace
}  // namespace stereotlm::process
