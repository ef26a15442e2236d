#pragma once

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// The first of the list that requests wins. No state.
class FixedPriorityPolicy : public ArbitrationPolicy {
 public:
  explicit FixedPriorityPolicy(const PriorityList& list) : list_(list) {}

  Port winner(State state, PortMask requests) const override;
  State next(State, PortMask, PortMask) const override { return 0; }

 private:
  PriorityList list_;
};

}  // namespace stereotlm::memory
