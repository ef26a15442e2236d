#include "sw/explore/sweep/claims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "sw/process/child_process.h"
#include "sw/process/shared_memory.h"

namespace stereotlm::explore {
namespace {

TEST(Claims, BeginsThePointsInTheirOrderAndCountsTheirEnds) {
  Claims claims(2, 7);
  const std::vector<PointEnd> ends = {PointEnd::kExcluded,   PointEnd::kKnown,  PointEnd::kOk,
                                      PointEnd::kImpossible, PointEnd::kFailed, PointEnd::kGivenUp,
                                      PointEnd::kOk};
  for (std::size_t point = 0; point < ends.size(); ++point) {
    EXPECT_EQ(claims.begin(point % 2), point);
    EXPECT_EQ(claims.counts().done(), point);
    claims.end(point % 2, ends[point]);
  }
  EXPECT_EQ(claims.begin(0), std::nullopt);
  EXPECT_EQ(counts_text(claims.counts()), counts_text({7, 1, 1, 2, 1, 1, 1}));
}

TEST(Claims, BeginsAnUnfinishedPointOfThePlaceAgain) {
  Claims claims(2, 3);
  EXPECT_EQ(claims.unfinished(1), std::nullopt);
  EXPECT_EQ(claims.begin(0), 0U);
  EXPECT_EQ(claims.begin(1), 1U);
  EXPECT_EQ(claims.unfinished(1), 1U);
  EXPECT_EQ(claims.begin(1), 1U);
  claims.end(1, PointEnd::kOk);
  EXPECT_EQ(claims.unfinished(1), std::nullopt);
  EXPECT_EQ(claims.begin(1), 2U);
  EXPECT_EQ(claims.begin(0), 0U);
}

TEST(Claims, BeginsNoPointOnceItIsStopped) {
  Claims claims(1, 3);
  EXPECT_EQ(claims.begin(0), 0U);
  claims.stop();
  EXPECT_EQ(claims.begin(0), std::nullopt) << "not even the unfinished one";
  EXPECT_EQ(claims.counts().done(), 0U);
}

TEST(Claims, GivesEachPointToOneOfManyProcesses) {
  constexpr std::size_t kProcesses = 4;
  constexpr std::uint64_t kPoints = 20000;
  Claims claims(kProcesses, kPoints);
  const process::SharedMemory memory(kPoints);
  auto* const times = static_cast<unsigned char*>(memory.data());  // [point]: how often it was begun
  std::vector<std::unique_ptr<process::ChildProcess>> children;
  for (std::size_t place = 0; place < kProcesses; ++place) {
    children.push_back(std::make_unique<process::ChildProcess>([&claims, times, place] {
      while (const auto point = claims.begin(place)) {
        ++times[*point];
        claims.end(place, PointEnd::kOk);
      }
      return 0;
    }));
  }
  for (const auto& child : children) EXPECT_EQ(child->wait(), 0);
  EXPECT_EQ(claims.counts().ok, kPoints);
  EXPECT_TRUE(std::all_of(times, times + kPoints, [](unsigned char number) { return number == 1; }));
}

}  // namespace
}  // namespace stereotlm::explore
