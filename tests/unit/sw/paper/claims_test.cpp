#include "sw/paper/claims.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "platform/config/board_yaml.h"

namespace stereotlm::paper {
namespace {

TEST(Claims, HaveUniqueNamesAndValidBoards) {
  std::set<std::string> names;
  for (const Claim& claim : claims()) {
    EXPECT_TRUE(names.insert(claim.name).second) << claim.name;
    EXPECT_FALSE(claim.cases.empty()) << claim.name;
    for (const Case& one : claim.cases) {
      EXPECT_FALSE(one.runs.empty()) << one.name;
      for (const BoardRun& run : one.runs) EXPECT_NO_THROW(platform::load_board(run.preset, run.sets));
    }
  }
}

TEST(Claims, OfTheWholeComputerBeginWithThePapersBoard) {
  int found = 0;
  for (const Claim& claim : claims()) {
    if (claim.quantity != Quantity::kBanksFound) continue;
    ++found;
    const BoardRun& first = claim.cases.front().runs.front();
    EXPECT_EQ(platform::load_board(first.preset, first.sets).banks.size(), claim.cases.front().printed);
    EXPECT_TRUE(first.sets.empty());
  }
  EXPECT_EQ(found, 1);
}

}  // namespace
}  // namespace stereotlm::paper
