#include "sw/paper/verdict.h"

#include <gtest/gtest.h>

namespace stereotlm::paper {
namespace {

constexpr auto kYes = Verdict::kConfirmed;
constexpr auto kNo = Verdict::kNotConfirmed;

TEST(Verdict, WithinPercentIsOfThePrintedValueToBothSides) {
  const Rule rule = {Relation::kWithinPercent, 0.5, ""};
  EXPECT_EQ(verdict_of(rule, 200, 201), kYes);
  EXPECT_EQ(verdict_of(rule, 200, 201.001), kNo);
  EXPECT_EQ(verdict_of(rule, 200, 199), kYes);
  EXPECT_EQ(verdict_of(rule, 200, 198.999), kNo);
}

TEST(Verdict, WithinIsADifferenceToBothSides) {
  const Rule rule = {Relation::kWithin, 1, "percentage point"};
  EXPECT_EQ(verdict_of(rule, 21, 22), kYes);
  EXPECT_EQ(verdict_of(rule, 21, 22.001), kNo);
  EXPECT_EQ(verdict_of(rule, 21, 20), kYes);
  EXPECT_EQ(verdict_of(rule, 21, 19.999), kNo);
}

TEST(Verdict, AtLeastHasNoUpperEnd) {
  const Rule rule = {Relation::kAtLeast, 0.5, "frames/s"};
  EXPECT_EQ(verdict_of(rule, 20, 19.5), kYes);
  EXPECT_EQ(verdict_of(rule, 20, 19.499), kNo);
  EXPECT_EQ(verdict_of(rule, 20, 2000), kYes);
}

TEST(Verdict, MoreIsNotAsMany) {
  const Rule rule = {Relation::kMore, 0, ""};
  EXPECT_EQ(verdict_of(rule, 20, 20.001), kYes);
  EXPECT_EQ(verdict_of(rule, 20, 20), kNo);
  EXPECT_EQ(verdict_of(rule, 20, 19.98), kNo);
  EXPECT_EQ(text_of(rule), "more than the printed value");
}

TEST(Verdict, FewerBanksThanNeededRefuteWhoeverHasFoundThem) {
  EXPECT_EQ(verdict_of_need(8, 7, true), kNo);
  EXPECT_EQ(verdict_of_need(8, 7, false), kNo);
}

TEST(Verdict, OnlyAProofConfirmsThatBanksAreNeeded) {
  EXPECT_EQ(verdict_of_need(8, 8, true), kYes);
  EXPECT_EQ(verdict_of_need(8, 9, true), kYes);
  EXPECT_EQ(verdict_of_need(8, 8, false), Verdict::kOpen);
}

TEST(Verdict, OfAClaimIsThatOfItsCasesIfTheyAgree) {
  EXPECT_EQ(verdict_of_all({kYes, kYes}), kYes);
  EXPECT_EQ(verdict_of_all({kNo, kNo}), kNo);
  EXPECT_EQ(verdict_of_all({Verdict::kOpen}), Verdict::kOpen);
  EXPECT_EQ(verdict_of_all({}), Verdict::kOpen);
}

TEST(Verdict, OfAClaimIsInPartIfSomeCasesAreConfirmed) {
  EXPECT_EQ(verdict_of_all({kYes, kNo}), Verdict::kInPart);
  EXPECT_EQ(verdict_of_all({Verdict::kOpen, kYes}), Verdict::kInPart);
  EXPECT_EQ(verdict_of_all({Verdict::kOpen, kNo}), kNo);
}

TEST(Verdict, RulesSayTheirTolerance) {
  EXPECT_EQ(text_of(Rule{Relation::kWithinPercent, 0.35, ""}), "within 0.35 %");
  EXPECT_EQ(text_of(Rule{Relation::kWithin, 1, "percentage point"}), "within 1 percentage point");
  EXPECT_EQ(text_of(Rule{Relation::kAtLeast, 0.5, "frames/s"}),
            "at least the printed value less 0.5 frames/s");
  EXPECT_EQ(text_of(Rule{Relation::kAtLeast, 0, ""}), "at least the printed value");
}

}  // namespace
}  // namespace stereotlm::paper
