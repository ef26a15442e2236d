#include "models/kernels/matching_cost.h"

namespace stereotlm::kernels {

const char* name_of(CostKind kind) {
  switch (kind) {
    case CostKind::kSad:
      return "sad";
    case CostKind::kSsd:
      return "ssd";
    case CostKind::kZncc:
      return "zncc";
    case CostKind::kCensus:
      break;
  }
  return "census";
}

std::vector<std::string> problems(const MatchingCost& cost) {
  std::vector<std::string> found;
  if (cost.kind == CostKind::kCensus) {
    kCensusSizeRule.check("census_size", cost.census_size, found);
  } else if (cost.census_size != 0) {
    found.push_back("census_size = " + std::to_string(cost.census_size) +
                    ": must be 0 unless the cost is census");
  }
  return found;
}

}  // namespace stereotlm::kernels
