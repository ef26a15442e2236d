#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// A policy that boards can choose.
struct PolicyEntry {
  const char* name;          // in board files
  const char* list_meaning;  // meaning of the priority list for this policy, for the list of keys
  // Whether the state is always 0 after a cycle in which every request was granted: then the arbitration of a
  // frame does not depend on the frames before it.
  bool forgets;
  std::unique_ptr<const ArbitrationPolicy> (*make)(const PriorityList& list);
};

// All policies, in the order in which they are listed. To add a policy, write its file pair and add its line
// to the table in arbitration_policies.cpp.
const std::vector<PolicyEntry>& arbitration_policies();
// Returns null if there is no policy of this name.
const PolicyEntry* find_arbitration_policy(const std::string& name);

}  // namespace stereotlm::memory
