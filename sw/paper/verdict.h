#pragma once

#include <string>
#include <vector>

namespace stereotlm::paper {

enum class Verdict {
  kConfirmed,
  kNotConfirmed,
  kInPart,  // of a claim: some of its cases are confirmed
  kOpen,    // what was tried does not decide it
};

// "confirmed", "not confirmed", "in part", "open"
std::string text_of(Verdict verdict);

// What makes a modelled value confirm a printed one.
enum class Relation {
  kWithinPercent,  // it differs by at most `tolerance` percent of the printed one
  kWithin,         // it differs by at most `tolerance`
  kAtLeast,        // it is at most `tolerance` below the printed one
  kMore,           // it is above the printed one
};

struct Rule {
  Relation relation = Relation::kWithin;
  double tolerance = 0;
  std::string unit;  // of the tolerance, behind it; percent apart
};

// "within 0.35 %", "within 1 point", "at least the printed value less 0.5 frames/s", "more than the printed
// value"
std::string text_of(const Rule& rule);

// kConfirmed or kNotConfirmed.
Verdict verdict_of(const Rule& rule, double printed, double modelled);

// "So many are needed": `found` is the fewest that were found to do. With fewer than `printed` the claim is
// wrong whoever has found them; that it is right takes a proof that no fewer do.
Verdict verdict_of_need(int printed, int found, bool is_proved);

// Of a claim, from those of its cases: theirs if they are all the same; else kInPart if one of them is
// confirmed, and kNotConfirmed if none is. kOpen without cases.
Verdict verdict_of_all(const std::vector<Verdict>& cases);

}  // namespace stereotlm::paper
