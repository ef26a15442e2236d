#include "models/memory/fixed_priority_policy.h"

#include <algorithm>

namespace stereotlm::memory {

Port FixedPriorityPolicy::winner(State, PortMask requests) const {
  return *std::find_if(list_.begin(), list_.end(),
                       [requests](Port port) { return (requests & mask_of(port)) != 0; });
}

}  // namespace stereotlm::memory
