#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// A policy that boards can choose.
struct PolicyEntry {
  const char* name;          // in board files
  const char* list_meaning;  // what the priority list is to it, as the key list says
  // After a cycle in which every request is granted the state is 0: a frame leaves nothing to the next.
  bool forgets;
  std::unique_ptr<const ArbitrationPolicy> (*make)(const PriorityList& list);
};

// All policies, in the order in which they are listed. To add one, add its line here and its file pair.
const std::vector<PolicyEntry>& arbitration_policies();
// Null if there is none of this name.
const PolicyEntry* find_arbitration_policy(const std::string& name);

}  // namespace stereotlm::memory
