#include "sw/paper/verdict.h"

#include <gtest/gtest.h>

#include <vector>

namespace stereotlm::paper {
namespace {

constexpr auto kYes = Verdict::kConfirmed;
constexpr auto kNo = Verdict::kNotConfirmed;

constexpr auto kOpen = Verdict::kOpen;

struct RuleCase {
  Rule rule;
  double printed;
  double modelled;
  Verdict expected;
};

TEST(Verdict, ConfirmsUpToBothEndsOfATolerance) {
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
  for (const RuleCase& one : cases)
    EXPECT_EQ(verdict_of(one.rule, one.printed, one.modelled), one.expected)
        << text_of(one.rule) << ": " << one.modelled;
}

TEST(Verdict, ConfirmsANeedOfBanksByAProofOnly) {
  EXPECT_EQ(verdict_of_need(8, 7, true), kNo);
  EXPECT_EQ(verdict_of_need(8, 7, false), kNo);
  EXPECT_EQ(verdict_of_need(8, 8, true), kYes);
  EXPECT_EQ(verdict_of_need(8, 9, true), kYes);
  EXPECT_EQ(verdict_of_need(8, 8, false), kOpen);
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
