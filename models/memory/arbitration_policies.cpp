#include "models/memory/arbitration_policies.h"

#include <algorithm>

#include "models/memory/age_policy.h"
#include "models/memory/fixed_priority_policy.h"
#include "models/memory/round_robin_policy.h"

namespace stereotlm::memory {
namespace {

template <typename Policy>
std::unique_ptr<const ArbitrationPolicy> make(const PriorityList& list) {
  return std::make_unique<Policy>(list);
}

}  // namespace

const std::vector<PolicyEntry>& arbitration_policies() {
  static const std::vector<PolicyEntry> kPolicies = {
      {"fixed_priority", "highest priority first", true, make<FixedPriorityPolicy>},
      {"round_robin", "the search order of round_robin", false, make<RoundRobinPolicy>},
      {"age", "with age the order of requests that have waited equally long", true, make<AgePolicy>},
  };
  return kPolicies;
}

const PolicyEntry* find_arbitration_policy(const std::string& name) {
  const auto& policies = arbitration_policies();
  const auto found = std::find_if(policies.begin(), policies.end(),
                                  [&name](const PolicyEntry& policy) { return name == policy.name; });
  return found == policies.end() ? nullptr : &*found;
}

}  // namespace stereotlm::memory
