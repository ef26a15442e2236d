#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <ostream>
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

// Nothing is freed: the payloads belong to the test.
class CountingManager : public tlm::tlm_mm_interface {
 public:
  int frees = 0;
  void free(tlm::tlm_generic_payload*) override { ++frees; }
};

// initiator -> monitor -> target, and two correct two-word reads at 0x40 to start from.
class ScriptedLink : public testing::Test {
 public:
  using Payload = tlm::tlm_generic_payload;

  explicit ScriptedLink(const ProtocolOptions& options = {}) : monitor("monitor", options) {
    initiator.socket.bind(monitor.from_initiator);
    monitor.to_target.bind(target.socket);
    prepare(payload);
    prepare(other);
  }

  void prepare(Payload& correct) {
    correct.set_command(tlm::TLM_READ_COMMAND);
    correct.set_address(0x40);
    correct.set_data_ptr(data.data());
    correct.set_data_length(8);
    correct.set_streaming_width(8);
  }
  // Acquires both payloads once, as nb_transport needs it.
  void manage() {
    for (Payload* managed : {&payload, &other}) {
      managed->set_mm(&manager);
      managed->acquire();
    }
  }

  static void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }
  // Simulates `body` as a thread process, until nothing is left to do.
  static void simulate(const std::function<void()>& body) {
    sc_core::sc_spawn(body);
    sc_core::sc_start();
  }

  void transport() { initiator.socket->b_transport(payload, delay); }
  tlm::tlm_sync_enum forward(Payload& sent, tlm::tlm_phase phase, sc_core::sc_time annotated = {}) {
    return initiator.socket->nb_transport_fw(sent, phase, annotated);
  }
  tlm::tlm_sync_enum backward(Payload& sent, tlm::tlm_phase phase, sc_core::sc_time annotated = {}) {
    if (phase == tlm::BEGIN_RESP) sent.set_response_status(tlm::TLM_OK_RESPONSE);
    return target.socket->nb_transport_bw(sent, phase, annotated);
  }
  bool request_dmi() { return initiator.socket->get_direct_mem_ptr(payload, dmi); }
  unsigned int debug() { return initiator.socket->transport_dbg(payload); }

  // The target's b_transport answers OK after `act`.
  void target_acts(std::function<void(Payload&, sc_core::sc_time&)> act) {
    target.on_blocking = [act = std::move(act)](Payload& received, sc_core::sc_time& annotated) {
      received.set_response_status(tlm::TLM_OK_RESPONSE);
      act(received, annotated);
    };
  }
  // The target grants 0x0..0x7f for reads, unless `spoil` changes that.
  void target_grants(
      std::function<void(tlm::tlm_dmi&)> spoil = [](auto&) {}, bool granted = true) {
    target.on_dmi = [this, spoil = std::move(spoil), granted](Payload&, tlm::tlm_dmi& given) {
      given.set_dmi_ptr(data.data());
      given.set_start_address(0);
      given.set_end_address(0x7f);
      given.allow_read();
      spoil(given);
      return granted;
    };
  }

  // Exactly one violation, with this text in it.
  void expect_only(const std::string& text) {
    const auto violations = monitor.take_violations();
    ASSERT_EQ(violations.size(), 1U) << testing::PrintToString(violations);
    EXPECT_NE(violations[0].find(text), std::string::npos) << violations[0];
  }

  ScriptedInitiator initiator{"initiator"};
  ScriptedTarget target{"target"};
  ProtocolMonitor monitor;
  CountingManager manager;
  std::array<unsigned char, 8> data{};
  std::array<unsigned char, 8> enables{};
  Payload payload;
  Payload other;
  tlm::tlm_dmi dmi;
  sc_core::sc_time delay;
};

// What the two ends of a link do, and the only violation that the monitor reports of it. Without a text it
// must report none: one that is left fails the test as the monitor is destroyed.
struct Exchange {
  const char* name;
  const char* violation;  // null: none
  std::function<void(ScriptedLink&)> happen;
  friend void PrintTo(const Exchange& exchange, std::ostream* out) { *out << exchange.name; }
};

class ExchangeTest : public ScriptedLink, public testing::WithParamInterface<Exchange> {
 public:
  void expect_its_violation() {
    elaborate();
    GetParam().happen(*this);
    if (GetParam().violation != nullptr) expect_only(GetParam().violation);
  }
  static std::string name(const testing::TestParamInfo<Exchange>& info) { return info.param.name; }
};

}  // namespace stereotlm::test
