#pragma once

#include <cstdint>

#include "models/memory/bank_arbiter.h"

namespace stereotlm::memory {

// A cycle of one arbiter, decided and counted. Returns the port that is granted.
inline PortMask arbitrate(BankArbiter& arbiter, std::uint64_t cycle, PortMask requests, PortMask writes) {
  const BankArbiter::Outcome outcome = arbiter.decide(cycle, requests, writes);
  arbiter.count(cycle, outcome);
  return arbiter.granted_in(outcome);
}

}  // namespace stereotlm::memory
