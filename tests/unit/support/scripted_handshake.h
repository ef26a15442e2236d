#pragma once

#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {

// A scripted link with two correct managed transactions, acquired once each, and calls of nb_transport in
// both directions.
class ScriptedHandshake : public ScriptedLink {
 protected:
  using Payload = tlm::tlm_generic_payload;

  ScriptedHandshake() {
    for (auto* managed : {&payload, &other}) {
      prepare(*managed);
      managed->set_mm(&manager);
      managed->acquire();
    }
  }

  // The next forward (backward) call is answered with this.
  void target_returns(tlm::tlm_sync_enum status, tlm::tlm_phase phase = tlm::UNINITIALIZED_PHASE,
                      const sc_core::sc_time& added = {}) {
    target.on_forward = [=](Payload& received, tlm::tlm_phase& returned, sc_core::sc_time& annotated) {
      if (phase != tlm::UNINITIALIZED_PHASE) returned = phase;
      if (status == tlm::TLM_COMPLETED || phase == tlm::BEGIN_RESP) {
        received.set_response_status(tlm::TLM_OK_RESPONSE);
      }
      annotated += added;
      return status;
    };
  }
  void initiator_returns(tlm::tlm_sync_enum status, tlm::tlm_phase phase = tlm::UNINITIALIZED_PHASE) {
    initiator.on_backward = [=](Payload&, tlm::tlm_phase& returned, sc_core::sc_time&) {
      if (phase != tlm::UNINITIALIZED_PHASE) returned = phase;
      return status;
    };
  }

  tlm::tlm_sync_enum forward(Payload& sent, tlm::tlm_phase phase, sc_core::sc_time annotated = {}) {
    return initiator.socket->nb_transport_fw(sent, phase, annotated);
  }
  tlm::tlm_sync_enum backward(Payload& sent, tlm::tlm_phase phase, sc_core::sc_time annotated = {}) {
    if (phase == tlm::BEGIN_RESP) sent.set_response_status(tlm::TLM_OK_RESPONSE);
    return target.socket->nb_transport_bw(sent, phase, annotated);
  }

  CountingManager manager;
  Payload other;
};

}  // namespace stereotlm::test
