#include "sw/paper/claims.h"

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"

namespace stereotlm::paper {
namespace {

const GivenPair kGiven = {"left.png", "right.png", "t/truth.png", 1.5, 107};

Claim costs(const std::optional<GivenPair>& given) {
  for (const Claim& claim : claims(given)) {
    if (claim.quantity == Quantity::kAccuracyChange) return claim;
  }
  throw std::out_of_range("costs");
}

TEST(Claims, HaveUniqueNamesAndValidBoards) {
  std::set<std::string> names;
  for (const Claim& claim : claims(kGiven)) {
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

TEST(Claims, OfCostsCompareSsdAndZnccWithSadOnEachScene) {
  const std::vector<Case> cases = costs(std::nullopt).cases;
  ASSERT_EQ(cases.size(), 6U);
  EXPECT_EQ(cases[0].name, "ssd, synthetic 1");
  EXPECT_EQ(cases[5].name, "zncc, synthetic 3");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    // The verdict is on the second run; census follows the last cost of a scene.
    const std::vector<std::string> compared = {"matcher.cost=sad",
                                               i % 2 == 0 ? "matcher.cost=ssd" : "matcher.cost=zncc"};
    ASSERT_EQ(cases[i].runs.size(), i % 2 == 0 ? 2U : 3U);
    for (std::size_t j = 0; j < cases[i].runs.size(); ++j) {
      const BoardRun& run = cases[i].runs[j];
      EXPECT_EQ(run.scene.value().synthetic, 1 + i / 2);
      EXPECT_FALSE(run.camera);
      EXPECT_EQ(run.sets, std::vector<std::string>{j < 2 ? compared[j] : "matcher.cost={census: 5}"});
    }
  }
}

TEST(Claims, OfCostsIncludeAGivenPairWithItsDisparities) {
  const std::vector<Case> cases = costs(kGiven).cases;
  ASSERT_EQ(cases.size(), 8U);
  const std::vector<std::string> options = {"--left",  "left.png",    "--right",       "right.png",
                                            "--truth", "t/truth.png", "--truth-scale", "1.5"};
  EXPECT_EQ(cases[7].name, "zncc, the given pair");
  for (const std::size_t i : {std::size_t{6}, std::size_t{7}}) {
    for (const BoardRun& run : cases[i].runs) {
      EXPECT_EQ(run.scene.value().synthetic, std::nullopt);
      EXPECT_EQ(run.scene.value().options, options);
      EXPECT_EQ(run.sets.front(), "matcher.disparities=107");
    }
  }
}

}  // namespace
}  // namespace stereotlm::paper
