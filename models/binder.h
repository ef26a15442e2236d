#pragma once

#include <string>
#include <tlm>

namespace stereotlm {

using InitiatorSocket = tlm::tlm_initiator_socket<32>;   // of 32 bits, of the base protocol
using TargetSocket = tlm::tlm_base_target_socket_b<32>;  // also the base of optional target sockets

// Binds a memory-mapped initiator to its target; the default does so directly. A test or a tracer overrides
// bind() to insert a module between the two. The override owns that module, and binds both sides of it during
// elaboration.
class Binder {
 public:
  virtual ~Binder() = default;
  // `link`: the name of the connection, unique within one board, such as "left_pixel_to_crossbar".
  virtual void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) {
    static_cast<void>(link);
    from.bind(to);
  }
};

}  // namespace stereotlm
