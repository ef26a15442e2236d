#include "sw/paper/document.h"

#include <gmock/gmock.h>

#include <optional>
#include <regex>
#include <sstream>

namespace stereotlm::paper {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// What the simulation has given, where every claim is as the paper says.
Findings as_printed(const std::optional<GivenPair>& given = std::nullopt) {
  Findings findings;
  for (const Claim& claim : claims(given)) {
    ClaimFinding found = {claim, {}, Verdict::kConfirmed};
    for (const Case& one : claim.cases) {
      Measured measured;
      measured.rate = measured.bound = one.printed;
      measured.limited_by = "matcher";
      if (one.runs.front().scene) measured.quality = {0.25, 90};
      found.cases.push_back(
          {one, one.printed, std::vector<Measured>(one.runs.size(), measured), Verdict::kConfirmed});
    }
    if (claim.quantity == Quantity::kBanksProved) {
      BankRow row;
      row.of = claim.name;
      row.banks = static_cast<int>(claim.cases.front().printed);
      row.allocations = row.reached_by = 1;
      findings.banks.push_back(row);
    }
    findings.claims.push_back(found);
  }
  return findings;
}

CaseFinding& row_of(Findings& findings, const std::string& claim, std::size_t number) {
  for (ClaimFinding& found : findings.claims) {
    if (found.claim.name == claim) return found.cases.at(number);
  }
  throw std::out_of_range(claim);
}

void refute(Findings& findings, const std::string& claim, std::size_t number, double modelled) {
  CaseFinding& found = row_of(findings, claim, number);
  found.modelled = found.runs.front().rate = found.runs.front().bound = modelled;
  found.verdict = Verdict::kNotConfirmed;
}

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

TEST(Document, DoubtsOnlyARowThatNeedsAnotherClockThanTheOthers) {
  Findings findings = as_printed();
  EXPECT_THAT(document(findings), Not(HasSubstr("doubt")));
  refute(findings, "table1", 4, 18.6);  // 7x7, printed 18.9
  const std::string text = document(findings);
  EXPECT_THAT(text, HasSubstr("The row of 7x7 deviates by 1.6 %. Reasons to doubt the printed 18.9:"));
  EXPECT_THAT(text, HasSubstr("- It needs 40.54 .. 40.75 MHz, which the rows that agree exclude."));
  EXPECT_THAT(text, HasSubstr("at their clock it would print 18.6 here"));
  EXPECT_THAT(text, HasSubstr("one pixel a cycle and 7 reads of each:\n  40e6 / (640 * 480 * 7) = 18.601."));
  refute(findings, "table1", 4, 18.85);
  EXPECT_THAT(document(findings), Not(HasSubstr("which the rows that agree exclude")));
}

TEST(Document, QuotesThePapersOwnRuleOnlyAgainstARateAboveIt) {
  Findings findings = as_printed();
  refute(findings, "table1", 3, 14.3);  // 9x9, printed 14.5: less than 40e6 / (640 * 480 * 9)
  EXPECT_THAT(document(findings), HasSubstr("The row of 9x9 deviates"));
  EXPECT_THAT(document(findings), Not(HasSubstr("the paper's own rule")));
}

TEST(Document, ConcludesWhetherTheBanksAreNeeded) {
  Findings findings = as_printed();
  EXPECT_THAT(document(findings), HasSubstr("needs 8 banks, just the paper's 8."));
  EXPECT_THAT(document(findings), HasSubstr("None of these gives with fewer banks what 8 give"));
  row_of(findings, "banks_of_computer", 0).modelled = 7;
  EXPECT_THAT(document(findings), HasSubstr("7 banks give what 8 give: so 8 are not needed"));
}

TEST(Document, ShowsTheAccuracyOfEachCostOnEachScene) {
  Findings findings = as_printed();
  CaseFinding& zncc = row_of(findings, "costs", 1);
  zncc.runs[1].quality = {1.5, 88};
  zncc.runs[1].slices_percent = 40;
  zncc.verdict = Verdict::kNotConfirmed;
  zncc.runs[2].quality = {0.125, 91};
  const std::string text = document(findings);
  EXPECT_THAT(text,
              HasSubstr("\n| synthetic 1 | sad | 0.250 | 90.000 |  |  | 0.00 |  |\n"
                        "| synthetic 1 | ssd | 0.250 | 90.000 | +0.000 | +0.000 | 0.00 | confirmed |\n"
                        "| synthetic 1 | zncc | 1.500 | 88.000 | +1.250 | -2.000 | 40.00 | not confirmed |\n"
                        "| synthetic 1 | census 5 | 0.125 | 91.000 | -0.125 | +1.000 | 0.00 | not judged |\n"
                        "| synthetic 2 | sad |"));
  const std::string table = tables(findings).at("costs.csv");
  EXPECT_THAT(table, HasSubstr("\nsynthetic 1,sad,0.25,90,0,0,0,,stereotlm run fpl2003 --set "
                               "matcher.cost=sad --source preloaded --synthetic 1\n"));
  EXPECT_THAT(table, HasSubstr("\nsynthetic 1,zncc,1.5,88,1.25,-2,40,not confirmed,stereotlm "));
}

TEST(Document, SaysOnWhichScenesTheVerdictOnCostsRests) {
  const GivenPair pair = {"left.png", "right.png", "truth.png", 1, 214};
  const auto says = [](const Findings& findings, const std::string& text) {
    EXPECT_THAT(document(findings), HasSubstr("),\non " + text + ".\n"));
    EXPECT_THAT(document(findings),
                HasSubstr("**confirmed, on " + text.substr(0, text.find(';')) + "** |\n"));
    EXPECT_THAT(summary(findings),
                HasSubstr("confirmed\n  on " + std::regex_replace(text, std::regex("\n"), "\n  ")));
  };
  says(as_printed(), "synthetic scenes only;\ngive --left, --right and --truth for a real pair");
  Findings findings = as_printed(pair);
  says(findings, "synthetic scenes and the given pair");
  row_of(findings, "costs", 6).runs[0].quality = {99.96, 80};
  says(findings,
       "synthetic scenes only;\nnot on the given pair, whose cases are open: sad itself is wrong in 99.96 % "
       "of "
       "its answers;\na pair with more than 50 % does not judge: check --truth-scale");
}

TEST(Document, ListsTheCommandsOfCostsThatAreNotCompared) {
  EXPECT_THAT(document(as_printed()),
              HasSubstr("\n$ stereotlm run fpl2003 --set 'matcher.cost={census: 5}' "));
}

TEST(Document, HasNoPrintedNumberOfCosts) {
  EXPECT_THAT(document(as_printed()), HasSubstr("\n| ssd, synthetic 1 |  | 0.000 |"));
  EXPECT_THAT(tables(as_printed()).at("claims.csv"),
              HasSubstr(",\"ssd, synthetic 1\",percentage points,,,0,"));
}

TEST(Document, SummaryFitsIntoAHundredColumns) {
  const GivenPair pair = {"left.png", "right.png", "truth.png", 1, 214};
  Findings findings = as_printed(pair);
  row_of(findings, "costs", 6).runs[0].quality = {100, 80};
  for (ClaimFinding& found : findings.claims) {
    found.verdict = Verdict::kNotConfirmed;
    for (CaseFinding& one : found.cases) one.verdict = Verdict::kOpen;
  }
  EXPECT_LE(longest_line(summary(findings)), 100U);
}

TEST(Document, SummaryListsWhatIsNotConfirmed) {
  Findings findings = as_printed();
  EXPECT_THAT(summary(findings), Not(HasSubstr("not confirmed")));
  refute(findings, "table1", 4, 18.6);
  EXPECT_THAT(summary(findings), HasSubstr("5 of 6"));
  EXPECT_THAT(summary(findings),
              HasSubstr("Where the model does not confirm the paper:\n"
                        "Table 1: frames per second against the window, 80 disparities\n"
                        "  7x7: 18.9 frames/s in the paper, 18.600 in the model (-1.59 %)\n"));
}

TEST(Document, SummaryListsTheChangesOfCostsThatAreNotConfirmed) {
  Findings findings = as_printed();
  CaseFinding& zncc = row_of(findings, "costs", 1);
  zncc.runs[1].quality = {1.5, 88};
  zncc.verdict = Verdict::kNotConfirmed;
  row_of(findings, "costs", 2).verdict = Verdict::kOpen;
  EXPECT_THAT(summary(findings),
              HasSubstr("\nsec. 2.1: almost the same results with SAD as with SSD and NCC\n"
                        "  zncc on synthetic 1: wrong +1.250, answered -2.000 percentage points against "
                        "sad\n"
                        "  ssd on synthetic 2: wrong +0.000, answered +0.000 percentage points against sad, "
                        "open\n"));
}

TEST(Document, SummaryBeginsWithTheClaimsThatAreNotConfirmed) {
  Findings findings = as_printed();
  const std::size_t claims = findings.claims.size();
  findings.claims[1].verdict = Verdict::kInPart;
  findings.claims[2].verdict = Verdict::kOpen;
  findings.claims[4].verdict = Verdict::kNotConfirmed;
  const std::string text = summary(findings);
  EXPECT_THAT(text, StartsWith(std::to_string(claims) +
                               " claims of the paper: 1 not confirmed, 1 in "
                               "part, 1 open, " +
                               std::to_string(claims - 3) + " confirmed.\n"));
  const auto line_of = [&](std::size_t claim) {
    return text.find('\n' + findings.claims[claim].claim.place + ": " + findings.claims[claim].claim.says +
                     ' ');
  };
  EXPECT_LT(line_of(4), line_of(1));
  EXPECT_LT(line_of(1), line_of(2));
  EXPECT_LT(line_of(2), line_of(0));
}

}  // namespace
}  // namespace stereotlm::paper
