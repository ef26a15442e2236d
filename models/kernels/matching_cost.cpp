#include "models/kernels/matching_cost.h"

#include <array>
#include <cstddef>

namespace stereotlm::kernels {

const char* name_of(CostKind kind) {
  static constexpr std::array<const char*, 4> kNames = {"sad", "ssd", "zncc", "census"};
  return kNames[static_cast<std::size_t>(kind)];
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
