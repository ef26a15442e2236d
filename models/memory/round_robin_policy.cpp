#include "models/memory/round_robin_policy.h"

namespace stereotlm::memory {

Port RoundRobinPolicy::winner(State state, PortMask requests) const {
  std::size_t place = state;
  while ((requests & mask_of(list_[place])) == 0) place = (place + 1) % list_.size();
  return list_[place];
}

ArbitrationPolicy::State RoundRobinPolicy::next(State state, PortMask, PortMask granted) const {
  if (granted == 0) return state;
  std::size_t place = 0;
  while (granted != mask_of(list_[place])) ++place;
  return static_cast<State>((place + 1) % list_.size());
}

}  // namespace stereotlm::memory
