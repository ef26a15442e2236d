#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "tests/support/protocol_monitor.h"

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

// The test counts the references itself; nothing is freed.
class CountingManager : public tlm::tlm_mm_interface {
 public:
  int frees = 0;
  void free(tlm::tlm_generic_payload*) override { ++frees; }
};

// initiator -> monitor -> target, and a correct two-word read at 0x40 to start from.
class ScriptedLink : public testing::Test {
 protected:
  explicit ScriptedLink(const ProtocolOptions& options = {}) : monitor("monitor", options) {
    initiator.socket.bind(monitor.from_initiator);
    monitor.to_target.bind(target.socket);
    prepare(payload);
  }

  void prepare(tlm::tlm_generic_payload& correct) {
    correct.set_command(tlm::TLM_READ_COMMAND);
    correct.set_address(0x40);
    correct.set_data_ptr(data.data());
    correct.set_data_length(8);
    correct.set_streaming_width(8);
  }

  static void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }

  // Simulates `body` as a thread process, until nothing is left to do.
  static void simulate(const std::function<void()>& body) {
    sc_core::sc_spawn(body);
    sc_core::sc_start();
  }

  void transport() { initiator.socket->b_transport(payload, delay); }

  // Exactly one violation, with this text in it: one mistake is told once.
  void expect_only(const std::string& text) {
    const auto violations = monitor.take_violations();
    ASSERT_EQ(violations.size(), 1U) << testing::PrintToString(violations);
    EXPECT_NE(violations[0].find(text), std::string::npos) << violations[0];
  }

  ScriptedInitiator initiator{"initiator"};
  ScriptedTarget target{"target"};
  ProtocolMonitor monitor;
  std::array<unsigned char, 8> data{};
  std::array<unsigned char, 8> enables{};
  tlm::tlm_generic_payload payload;
  sc_core::sc_time delay;
};

}  // namespace stereotlm::test
