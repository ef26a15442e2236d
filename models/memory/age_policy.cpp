#include "models/memory/age_policy.h"

namespace stereotlm::memory {
namespace {

// A state holds each place of the queue in kPlaceBits bits: 1 + index of the port, or 0 behind the last port.
// The oldest request is in the lowest bits.
constexpr unsigned kPlaceBits = 3;
constexpr ArbitrationPolicy::State kPlaceMask = (1U << kPlaceBits) - 1;
static_assert(kMostPorts <= kPlaceMask && kMostPorts * kPlaceBits <= 32);

}  // namespace

std::vector<Port> AgePolicy::oldest_first(State state, PortMask requests) const {
  std::vector<Port> order;
  const auto add = [&](Port port) {
    if ((requests & mask_of(port)) == 0) return;
    requests = static_cast<PortMask>(requests & ~mask_of(port));
    order.push_back(port);
  };
  for (; state != 0; state >>= kPlaceBits) add(static_cast<Port>((state & kPlaceMask) - 1));
  for (const Port port : list_) add(port);
  return order;
}

Port AgePolicy::winner(State state, PortMask requests) const { return oldest_first(state, requests).front(); }

ArbitrationPolicy::State AgePolicy::next(State state, PortMask requests, PortMask granted) const {
  State queue = 0;
  unsigned bit = 0;
  for (const Port port : oldest_first(state, static_cast<PortMask>(requests & ~granted))) {
    queue |= static_cast<State>(port + 1) << bit;
    bit += kPlaceBits;
  }
  return queue;
}

}  // namespace stereotlm::memory
