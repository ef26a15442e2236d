#include "sw/explore/sweep/claims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "sw/process/child.h"
#include "sw/process/shared_memory.h"

namespace stereotlm::explore {
namespace {

TEST(Claims, GivesEachPointToOneOfManyProcesses) {
  constexpr std::size_t kProcesses = 4;
  constexpr std::uint64_t kPoints = 20000;
  Claims claims(kProcesses, kPoints);
  const process::SharedMemory memory(kPoints);
  auto* const times = static_cast<unsigned char*>(memory.data());  // [point]: how often it was begun
  std::vector<std::unique_ptr<process::Child>> children;
  for (std::size_t place = 0; place < kProcesses; ++place) {
    children.push_back(std::make_unique<process::Child>([&claims, times, place](const auto& /*tell*/) {
      while (const auto point = claims.begin(place)) {
        ++times[*point];
        claims.end(place, PointEnd::kOk);
      }
    }));
  }
  for (const auto& child : children) EXPECT_EQ(child->next(), std::nullopt);
  EXPECT_EQ(claims.counts().ok, kPoints);
  EXPECT_TRUE(std::all_of(times, times + kPoints, [](unsigned char number) { return number == 1; }));
}

}  // namespace
}  // namespace stereotlm::explore
