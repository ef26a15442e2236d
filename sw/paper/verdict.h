#pragma once

#include <string>
#include <vector>

namespace stereotlm::paper {

enum class Verdict {
  kConfirmed,
  kNotConfirmed,
  kInPart,  // a claim of which only some cases are confirmed
  kOpen,    // the simulated boards do not decide it
};

// "confirmed", "not confirmed", "in part", "open"
std::string text_of(Verdict verdict);

// The rule by which a modelled value confirms a printed one.
enum class Relation {
  kWithinPercent,  // the values differ by at most `tolerance` percent of the printed one
  kWithin,         // the values differ by at most `tolerance`
  kAtLeast,        // the modelled value is at most `tolerance` below the printed one
  kMore,           // the modelled value is above the printed one
};

struct Rule {
  Relation relation = Relation::kWithin;
  double tolerance = 0;
  std::string unit;  // unit of the tolerance, except for percent
};

// "within 0.35 %", "within 1 point", "at least the printed value less 0.5 frames/s", "more than the printed
// value"
std::string text_of(const Rule& rule);

// Returns kConfirmed or kNotConfirmed.
Verdict verdict_of(const Rule& rule, double printed, double modelled);

// The verdict on the claim that `printed` banks are needed. `found` is the smallest number of banks that was
// found to be enough. If it is below `printed`, the claim is not confirmed. Otherwise the claim is confirmed
// if a proof shows that fewer banks are not enough, and open if there is no proof.
Verdict verdict_of_need(int printed, int found, bool is_proved);

// The verdict on a claim, from the verdicts on its cases. If all cases have the same verdict, the claim has
// it too. Otherwise the verdict is kInPart if some case is confirmed, at least in part, else kNotConfirmed.
// Without cases it is kOpen.
Verdict verdict_of_all(const std::vector<Verdict>& cases);

}  // namespace stereotlm::paper
