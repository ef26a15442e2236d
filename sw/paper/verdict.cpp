#include "sw/paper/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stereotlm::paper {

std::string text_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConfirmed:
      return "confirmed";
    case Verdict::kNotConfirmed:
      return "not confirmed";
    case Verdict::kInPart:
      return "in part";
    case Verdict::kOpen:
      break;
  }
  return "open";
}

std::string text_of(const Rule& rule) {
  const std::string unit = rule.unit.empty() ? "" : ' ' + rule.unit;
  switch (rule.relation) {
    case Relation::kWithinPercent:
      return fmt::format("within {:g} %", rule.tolerance);
    case Relation::kWithin:
      return fmt::format("within {:g}{}", rule.tolerance, unit);
    case Relation::kMore:
      return "more than the printed value";
    case Relation::kAtLeast:
      break;
  }
  if (rule.tolerance == 0) return "at least the printed value";
  return fmt::format("at least the printed value less {:g}{}", rule.tolerance, unit);
}

Verdict verdict_of(const Rule& rule, double printed, double modelled) {
  if (rule.relation == Relation::kMore)
    return modelled > printed ? Verdict::kConfirmed : Verdict::kNotConfirmed;
  double most = rule.tolerance;
  if (rule.relation == Relation::kWithinPercent) most *= std::abs(printed) / 100;
  const double away = rule.relation == Relation::kAtLeast ? printed - modelled : std::abs(modelled - printed);
  return away <= most ? Verdict::kConfirmed : Verdict::kNotConfirmed;
}

Verdict verdict_of_need(int printed, int found, bool is_proved) {
  if (found < printed) return Verdict::kNotConfirmed;
  return is_proved ? Verdict::kConfirmed : Verdict::kOpen;
}

Verdict verdict_of_all(const std::vector<Verdict>& cases) {
  if (cases.empty()) return Verdict::kOpen;
  const bool are_same =
      std::all_of(cases.begin(), cases.end(), [&](Verdict one) { return one == cases.front(); });
  if (are_same) return cases.front();
  const bool any = std::any_of(cases.begin(), cases.end(), [](Verdict one) {
    return one == Verdict::kConfirmed || one == Verdict::kInPart;
  });
  if (any) return Verdict::kInPart;
  return Verdict::kNotConfirmed;  // no case is confirmed, and some are refuted
}

}  // namespace stereotlm::paper
