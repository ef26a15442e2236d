#pragma once

#include <functional>
#include <systemc>
#include <tlm>

namespace stereotlm::test {

// An initiator that answers the backward path as the test says.
class ScriptedInitiator : public sc_core::sc_module, public tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_initiator_socket<32> socket{"socket"};
  explicit ScriptedInitiator(const sc_core::sc_module_name& name) : sc_module(name) { socket.bind(*this); }

  std::function<tlm::tlm_sync_enum(tlm::tlm_generic_payload&, tlm::tlm_phase&, sc_core::sc_time&)>
      on_backward = [](auto&, auto&, auto&) { return tlm::TLM_ACCEPTED; };
  int invalidations = 0;

  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return on_backward(payload, phase, delay);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) override { ++invalidations; }
};

// A target that answers the forward path as the test says; by default correctly and at once.
class ScriptedTarget : public sc_core::sc_module, public tlm::tlm_fw_transport_if<> {
 public:
  tlm::tlm_target_socket<32> socket{"socket"};
  explicit ScriptedTarget(const sc_core::sc_module_name& name) : sc_module(name) { socket.bind(*this); }

  std::function<void(tlm::tlm_generic_payload&, sc_core::sc_time&)> on_blocking = [](auto& payload, auto&) {
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  std::function<tlm::tlm_sync_enum(tlm::tlm_generic_payload&, tlm::tlm_phase&, sc_core::sc_time&)>
      on_forward = [](auto&, auto&, auto&) { return tlm::TLM_ACCEPTED; };
  std::function<bool(tlm::tlm_generic_payload&, tlm::tlm_dmi&)> on_dmi = [](auto&, auto&) { return false; };
  std::function<unsigned int(tlm::tlm_generic_payload&)> on_debug = [](auto& payload) {
    return payload.get_data_length();
  };

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override {
    on_blocking(payload, delay);
  }
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return on_forward(payload, phase, delay);
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) override {
    return on_dmi(payload, dmi);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& payload) override { return on_debug(payload); }
};

}  // namespace stereotlm::test
