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
  kWithinPercent,  // it differs by at most `tolerance` percent of the printed one
  kWithin,         // it differs by at most `tolerance`
  kAtLeast,        // it is at most `tolerance` below the printed one
  kMore,           // it is above the printed one
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

// For the claim that `printed` are needed. `found`: the fewest that were found to be enough. Fewer than `printed`
// refute the claim in any case. To confirm it takes a proof that no fewer are enough.
Verdict verdict_of_need(int printed, int found, bool is_proved);

// The verdict on a claim from those on its cases. If all are equal, it is theirs. Otherwise it is kInPart if some
// case is confirmed, else kNotConfirmed. Without cases it is kOpen.
Verdict verdict_of_all(const std::vector<Verdict>& cases);

}  // namespace stereotlm::paper
