#pragma once

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// Of the requesting ports, the one that comes first in the priority list wins. There is no state.
class FixedPriorityPolicy : public ArbitrationPolicy {
 public:
  explicit FixedPriorityPolicy(const PriorityList& list) : list_(list) {}

  Port winner(State state, PortMask requests) const override;
  State next(State, PortMask, PortMask) const override { return 0; }

 private:
  PriorityList list_;
};

}  // namespace stereotlm::memory
