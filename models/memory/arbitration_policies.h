#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// A policy that boards can choose. It picks one of the ports that request a bank in a cycle (contract section
// 2), by two pure functions of the priority list and of a small state. BankArbiter holds the state, so that
// one policy serves any number of cycles and banks, and memoises both functions, so that they need not be
// fast. The reachable states should be few: the memo and the transition cache of the core hold each of them
// once.
//
// An uncontended port is granted without its arbiter, which receives the number of grants later. For this to
// be exact, a request without competitors must win, and each further grant to the same port must change the
// state as a cycle without request does.
struct ArbitrationPolicy {
  using State = std::uint32_t;  // 0 at the start of the simulation

  const char* name;          // in board files
  const char* list_meaning;  // meaning of the priority list for this policy, for the list of keys
  // Whether the state is always 0 after a cycle in which every request was granted: then the arbitration of a
  // frame does not depend on the frames before it.
  bool forgets;
  // Returns the port that wins. `requests` has at least one port.
  Port (*winner)(const PriorityList& list, State state, PortMask requests);
  // Returns the state after a cycle. `granted`: mask of the winner; 0 if no port requested, or the bank was
  // turning round.
  State (*next)(const PriorityList& list, State state, PortMask requests, PortMask granted);
};

// All policies, in the order in which they are listed. To add one, write its functions and add its line to
// the table in arbitration_policies.cpp.
const std::vector<ArbitrationPolicy>& arbitration_policies();
// Returns null if there is no policy of this name.
const ArbitrationPolicy* find_arbitration_policy(const std::string& name);

}  // namespace stereotlm::memory
