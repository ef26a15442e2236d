#pragma once

#include <cstdint>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// Picks one of the ports that request a bank in a cycle (contract section 2). A policy consists of two pure
// functions of a small state. BankArbiter holds the state, so that one policy serves any number of cycles and
// banks, and memoises both functions, so that they need not be fast. The reachable states should be few: the
// memo and the transition cache of the core hold each of them once.
//
// An uncontended port is granted without its arbiter, which receives the number of grants later. For this to
// be exact, a request without competitors must win, and each further grant to the same port must change the
// state as a cycle without request does.
class ArbitrationPolicy {
 public:
  using State = std::uint32_t;  // 0 at the start of the simulation

  virtual ~ArbitrationPolicy() = default;

  // Returns the port that wins. `requests` has at least one port.
  virtual Port winner(State state, PortMask requests) const = 0;
  // Returns the state after a cycle. `granted`: mask of the winner; 0 if no port requested, or the bank was
  // turning round.
  virtual State next(State state, PortMask requests, PortMask granted) const = 0;
};

}  // namespace stereotlm::memory
