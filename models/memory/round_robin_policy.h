#pragma once

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// The first requesting port wins in a cyclic search of the priority list, which begins after the last port
// granted. The state is the place in the list where the search begins; a refusal because of turnaround does
// not change it.
class RoundRobinPolicy : public ArbitrationPolicy {
 public:
  explicit RoundRobinPolicy(const PriorityList& list) : list_(list) {}

  Port winner(State state, PortMask requests) const override;
  State next(State state, PortMask requests, PortMask granted) const override;

 private:
  PriorityList list_;
};

}  // namespace stereotlm::memory
