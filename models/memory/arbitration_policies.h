#pragma once

#include <string>
#include <vector>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// A policy that boards can choose: it orders the ports of a bank (contract section 2). Of the ports that
// request in a cycle, the one that comes first in the order wins. At power-up the order is the priority list.
// BankArbiter holds the order, so that one policy serves any number of banks.
//
// The order is the whole state of an arbiter. Two rules let cycles be skipped. After a cycle without request,
// further ones change nothing. After an uncontended grant, each further one to the same port acts as a cycle
// without request does: an uncontended port is granted without its arbiter, which gets the number of grants
// later. An order that depends on elapsed time, or on the number of grants, breaks them.
struct ArbitrationPolicy {
  const char* name;          // in board files
  const char* list_meaning;  // meaning of the priority list for this policy, for the list of keys
  // Whether the order is the priority list again after a cycle in which every request was granted: then the
  // arbitration of a frame does not depend on the frames before it.
  bool forgets;
  // Changes the order after a cycle. `granted`: mask of the winner; 0 if no port requested, or the bank was
  // turning round. Null: the order never changes.
  void (*advance)(const PriorityList& list, PriorityList& order, PortMask requests, PortMask granted);
};

// All policies, in the order in which they are listed. To add one, write its function and add its line to
// the table in arbitration_policies.cpp.
const std::vector<ArbitrationPolicy>& arbitration_policies();
// Returns null if there is no policy of this name.
const ArbitrationPolicy* find_arbitration_policy(const std::string& name);

}  // namespace stereotlm::memory
