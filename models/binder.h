#pragma once

#include <string>
#include <tlm>

namespace stereotlm {

using InitiatorSocket = tlm::tlm_initiator_socket<32>;
using TargetSocket = tlm::tlm_base_target_socket_b<32>;  // whether or not it may be left unbound

// Binds a memory-mapped initiator to its target. The default binds them directly; a test or a tracer
// overrides it to put a module of its own between the two (it owns that module, and binds both sides during
// elaboration).
class Binder {
 public:
  virtual ~Binder() = default;
  // `link` names the connection, unique within one board: "left_pixel_to_crossbar", "crossbar_to_bank0".
  virtual void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) {
    static_cast<void>(link);
    from.bind(to);
  }
};

}  // namespace stereotlm
