#include "models/memory/arbitration_policies.h"

#include <algorithm>

namespace stereotlm::memory {
namespace {

// round_robin: the list is searched cyclically, beginning after the last port granted. A refusal because of
// turnaround does not change where the search begins.
void rotate_behind_winner(const PriorityList& list, PriorityList& order, PortMask /*requests*/,
                          PortMask granted) {
  if (granted == 0) return;
  const auto winner = std::find(list.begin(), list.end(), lowest_port(granted));
  std::rotate_copy(list.begin(), winner + 1, list.end(), order.begin());
}

// age: the request with the largest age wins. Among equal ages, the port wins that comes first in the list.
// The age of a request is the number of consecutive cycles, up to this one, in which its port has requested
// the bank without a grant.
//
// The order begins with the ports that wait: those that requested in the last cycle and were not granted, the
// oldest first, equal ages in the order of the list. All others follow in the order of the list. This
// determines every decision:
// - The age of each waiting port grows by one in every cycle in which it requests. So the order of two
//   waiting ports never changes. Equal ages stay equal, and the list always orders them in the same way.
// - A new request has age 1. The request of a waiting port has age 2 or more. So new requests come behind the
//   waiting ports, in the order of the list.
// - A grant or a cycle without request ends an age: the port returns to its place in the list.
void put_waiting_first(const PriorityList& list, PriorityList& order, PortMask requests, PortMask granted) {
  if (requests == granted) {  // nobody waits
    std::copy(list.begin(), list.end(), order.begin());
    return;
  }
  const auto waiting = requests & ~granted;
  const auto waits = [waiting](Port port) { return has(waiting, port); };
  const auto behind_waiting =
      std::remove_if(order.begin(), order.end(), [&waits](Port port) { return !waits(port); });
  std::remove_copy_if(list.begin(), list.end(), behind_waiting, waits);
}

}  // namespace

const std::vector<ArbitrationPolicy>& arbitration_policies() {
  static const std::vector<ArbitrationPolicy> kPolicies = {
      {"fixed_priority", "highest priority first", true, nullptr},
      {"round_robin", "the search order of round_robin", false, rotate_behind_winner},
      {"age", "with age the order of requests that have waited equally long", true, put_waiting_first},
  };
  return kPolicies;
}

const ArbitrationPolicy* find_arbitration_policy(const std::string& name) {
  const auto& policies = arbitration_policies();
  const auto found = std::find_if(policies.begin(), policies.end(),
                                  [&name](const ArbitrationPolicy& policy) { return name == policy.name; });
  return found == policies.end() ? nullptr : &*found;
}

}  // namespace stereotlm::memory
