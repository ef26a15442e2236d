#pragma once

#include <vector>

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// The request with the largest age wins. Among equal ages, the port wins that comes first in the priority
// list. The age of a request is the number of consecutive cycles, up to this one, in which its port has
// requested the bank without a grant.
//
// The state is the queue of the ports that wait: those that requested in the last cycle and were not granted,
// the oldest first, equal ages in the order of the list. The order alone determines every decision:
// - The age of each waiting port grows by one in every cycle in which it requests. So the order of two
//   waiting ports never changes. Equal ages stay equal, and the list always orders them in the same way.
// - A new request has age 1. The request of a waiting port has age 2 or more. So new requests join the end of
//   the queue, in the order of the list.
// - A grant or a cycle without request ends an age: the port leaves the queue.
// Ages have no bound, but there are only 1,957 queues: the ordered selections from six ports.
class AgePolicy : public ArbitrationPolicy {
 public:
  explicit AgePolicy(const PriorityList& list) : list_(list) {}

  Port winner(State state, PortMask requests) const override;
  State next(State state, PortMask requests, PortMask granted) const override;

 private:
  // The ports of `requests`, in the order in which they would win.
  std::vector<Port> oldest_first(State state, PortMask requests) const;

  PriorityList list_;
};

}  // namespace stereotlm::memory
