#include "models/memory/arbitration_policies.h"

#include <algorithm>

namespace stereotlm::memory {
namespace {

using State = ArbitrationPolicy::State;

// fixed_priority: of the requesting ports, the one that comes first in the list wins. There is no state.

Port fixed_priority_winner(const PriorityList& list, State /*state*/, PortMask requests) {
  return *std::find_if(list.begin(), list.end(),
                       [requests](Port port) { return (requests & mask_of(port)) != 0; });
}

State no_state(const PriorityList& /*list*/, State /*state*/, PortMask /*requests*/, PortMask /*granted*/) {
  return 0;
}

// round_robin: the first requesting port wins in a cyclic search of the list, which begins after the last
// port granted. The state is the place in the list where the search begins; a refusal because of turnaround
// does not change it.

Port round_robin_winner(const PriorityList& list, State state, PortMask requests) {
  std::size_t place = state;
  while ((requests & mask_of(list[place])) == 0) place = (place + 1) % list.size();
  return list[place];
}

State round_robin_next(const PriorityList& list, State state, PortMask /*requests*/, PortMask granted) {
  if (granted == 0) return state;
  std::size_t place = 0;
  while (granted != mask_of(list[place])) ++place;
  return static_cast<State>((place + 1) % list.size());
}

// age: the request with the largest age wins. Among equal ages, the port wins that comes first in the list.
// The age of a request is the number of consecutive cycles, up to this one, in which its port has requested
// the bank without a grant.
//
// The state is the queue of the ports that wait: those that requested in the last cycle and were not granted,
// the oldest first, equal ages in the order of the list. The order alone determines every decision:
// - The age of each waiting port grows by one in every cycle in which it requests. So the order of two
//   waiting ports never changes. Equal ages stay equal, and the list always orders them in the same way.
// - A new request has age 1. The request of a waiting port has age 2 or more. So new requests join the end of
//   the queue, in the order of the list.
// - A grant or a cycle without request ends an age: the port leaves the queue.
// Ages have no bound, but there are only 1,957 queues: the ordered selections from six ports.
//
// A state holds each place of the queue in kPlaceBits bits: 1 + index of the port, or 0 behind the last port.
// The oldest request is in the lowest bits.
constexpr unsigned kPlaceBits = 3;
constexpr State kPlaceMask = (1U << kPlaceBits) - 1;
static_assert(kMostPorts <= kPlaceMask && kMostPorts * kPlaceBits <= 32);

// The ports of `requests`, in the order in which they would win.
std::vector<Port> oldest_first(const PriorityList& list, State state, PortMask requests) {
  std::vector<Port> order;
  const auto add = [&](Port port) {
    if ((requests & mask_of(port)) == 0) return;
    requests = static_cast<PortMask>(requests & ~mask_of(port));
    order.push_back(port);
  };
  for (; state != 0; state >>= kPlaceBits) add(static_cast<Port>((state & kPlaceMask) - 1));
  for (const Port port : list) add(port);
  return order;
}

Port age_winner(const PriorityList& list, State state, PortMask requests) {
  return oldest_first(list, state, requests).front();
}

State age_next(const PriorityList& list, State state, PortMask requests, PortMask granted) {
  State queue = 0;
  unsigned bit = 0;
  for (const Port port : oldest_first(list, state, static_cast<PortMask>(requests & ~granted))) {
    queue |= static_cast<State>(port + 1) << bit;
    bit += kPlaceBits;
  }
  return queue;
}

}  // namespace

const std::vector<ArbitrationPolicy>& arbitration_policies() {
  static const std::vector<ArbitrationPolicy> kPolicies = {
      {"fixed_priority", "highest priority first", true, fixed_priority_winner, no_state},
      {"round_robin", "the search order of round_robin", false, round_robin_winner, round_robin_next},
      {"age", "with age the order of requests that have waited equally long", true, age_winner, age_next},
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
