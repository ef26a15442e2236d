#include "sw/paper/claims.h"

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/area/area.h"
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

// The one constant of the area model (area.h), for the least squared error over the rows of Table 2: images
// of 640x480, windows of 7x7, tables and filters for both sides.
TEST(Claims, OfSizesAreWhatTheConstantOfTheAreaModelIsFittedTo) {
  const area::Device& device = *area::find_device("xc2v6000");
  const double documented_errors[] = {0.96, 0.02, -0.41};  // percentage points
  const std::pair<int, double> rows[] = {{80, 21}, {160, 43}, {200, 54}};
  const std::vector<Case> cases = claims()[1].cases;
  ASSERT_EQ(cases.size(), 3U);
  double product = 0;
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cases[i].printed, rows[i].second);
    EXPECT_EQ(cases[i].runs.front().sets.front(), "matcher.disparities=" + std::to_string(rows[i].first));
    fpga::CoreConfig core;
    core.disparities = rows[i].first;
    const area::Area area = area::total(area::items(core), device);
    EXPECT_NEAR(area.slices_percent - rows[i].second, documented_errors[i], 0.005);
    const auto places = static_cast<double>(area.lut_equivalents);
    product += places * rows[i].second * static_cast<double>(device.slices) / 100;
    square += places * places;
  }
  // As printed, with four decimals.
  EXPECT_NEAR(product / square, area::kSlicesPerLutEquivalent, 0.00005);
}

constexpr auto kYes = Verdict::kConfirmed;
constexpr auto kNo = Verdict::kNotConfirmed;
constexpr auto kOpen = Verdict::kOpen;

TEST(Verdict, ConfirmsUpToBothEndsOfATolerance) {
  struct RuleCase {
    Rule rule;
    double printed;
    double modelled;
    Verdict expected;
  };
  const Rule percent = {Relation::kWithinPercent, 0.5, ""};
  const Rule difference = {Relation::kWithin, 1, "percentage point"};
  const Rule least = {Relation::kAtLeast, 0.5, "frames/s"};
  const Rule more = {Relation::kMore, 0, ""};
  const std::vector<RuleCase> cases = {
      {percent, 200, 201, kYes},    {percent, 200, 201.001, kNo},  {percent, 200, 199, kYes},
      {percent, 200, 198.999, kNo}, {difference, 21, 22, kYes},    {difference, 21, 22.001, kNo},
      {difference, 21, 20, kYes},   {difference, 21, 19.999, kNo}, {least, 20, 19.5, kYes},
      {least, 20, 19.499, kNo},     {least, 20, 2000, kYes},       {more, 20, 20.001, kYes},
      {more, 20, 20, kNo},          {more, 20, 19.98, kNo}};
  for (const RuleCase& one : cases) {
    Claim claim;
    claim.rule = one.rule;
    EXPECT_EQ(verdict_of(claim, one.printed, one.modelled), one.expected)
        << text_of(one.rule) << ": " << one.modelled;
  }
}

TEST(Verdict, ConfirmsANeedOfBanksByAProofOnly) {
  Claim claim = {"", "", "", Quantity::kBanksProved, {Relation::kAtLeast, 0, ""}, 0, {}};
  EXPECT_EQ(verdict_of(claim, 8, 7), kNo);
  EXPECT_EQ(verdict_of(claim, 8, 8), kYes);
  claim.quantity = Quantity::kBanksFound;
  EXPECT_EQ(verdict_of(claim, 8, 7), kNo);
  EXPECT_EQ(verdict_of(claim, 8, 8), kOpen);
}

TEST(Verdict, OfAClaimJoinsThoseOfItsCases) {
  EXPECT_EQ(verdict_of_all({kYes, kYes}), kYes);
  EXPECT_EQ(verdict_of_all({kNo, kNo}), kNo);
  EXPECT_EQ(verdict_of_all({kOpen}), kOpen);
  EXPECT_EQ(verdict_of_all({}), kOpen);
  EXPECT_EQ(verdict_of_all({kYes, kNo}), Verdict::kInPart);
  EXPECT_EQ(verdict_of_all({kOpen, kYes}), Verdict::kInPart);
  EXPECT_EQ(verdict_of_all({kOpen, kNo}), kNo);
}

TEST(Verdict, TextOfARuleNamesItsTolerance) {
  EXPECT_EQ(text_of(Rule{Relation::kMore, 0, ""}), "more than the printed value");
  EXPECT_EQ(text_of(Rule{Relation::kWithinPercent, 0.35, ""}), "within 0.35 %");
  EXPECT_EQ(text_of(Rule{Relation::kWithin, 1, "percentage point"}), "within 1 percentage point");
  EXPECT_EQ(text_of(Rule{Relation::kAtLeast, 0.5, "frames/s"}),
            "at least the printed value less 0.5 frames/s");
  EXPECT_EQ(text_of(Rule{Relation::kAtLeast, 0, ""}), "at least the printed value");
}

}  // namespace
}  // namespace stereotlm::paper
