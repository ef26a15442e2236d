#include "tests/unit/support/scripted_handshake.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::tlm_phase;

using ProtocolMonitorHandshakes = ScriptedHandshake;

// The payload.

TEST_F(ProtocolMonitorHandshakes, CatchAWrongRequest) {
  elaborate();
  payload.set_streaming_width(0);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: streaming width = 0");
}

TEST_F(ProtocolMonitorHandshakes, CatchAResponseWithoutStatus) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  tlm_phase phase = tlm::BEGIN_RESP;
  target.socket->nb_transport_bw(payload, phase, delay);
  expect_only("nb_transport_bw: response status = 0");
}

TEST_F(ProtocolMonitorHandshakes, CatchACompletionWithoutStatus) {
  elaborate();
  target.on_forward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: response status = 0");
}

TEST_F(ProtocolMonitorHandshakes, CatchATargetThatChangesTheAddressBeforeItReturns) {
  elaborate();
  target.on_forward = [](Payload& received, auto&, auto&) {
    received.set_address(0);
    received.set_response_status(tlm::TLM_OK_RESPONSE);
    return tlm::TLM_COMPLETED;
  };
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: address changed");
}

TEST_F(ProtocolMonitorHandshakes, CatchAnInitiatorThatChangesWrittenDataBeforeTheResponse) {
  elaborate();
  payload.set_write();
  forward(payload, tlm::BEGIN_REQ);
  data[3] = 1;
  initiator_returns(tlm::TLM_ACCEPTED);
  backward(payload, tlm::END_REQ);
  expect_only("nb_transport_bw: data array of a write changed");
}

TEST_F(ProtocolMonitorHandshakes, CatchATransactionWithoutMemoryManager) {
  elaborate();
  payload.set_mm(nullptr);
  target_returns(tlm::TLM_COMPLETED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("no memory manager");
}

TEST_F(ProtocolMonitorHandshakes, CatchATransactionThatNobodyAcquired) {
  elaborate();
  payload.release();
  target_returns(tlm::TLM_COMPLETED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("reference count = 0");
}

// Time, and the other transport.

TEST_F(ProtocolMonitorHandshakes, CatchAResponseBeforeItsRequest) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ, sc_time(10, SC_NS));
  backward(payload, tlm::BEGIN_RESP, sc_time(9, SC_NS));
  expect_only("time 9 ns after 10 ns");
}

TEST_F(ProtocolMonitorHandshakes, PassAResponseAtTheTimeOfItsRequest) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ, sc_time(10, SC_NS));
  backward(payload, tlm::BEGIN_RESP, sc_time(10, SC_NS));
}

TEST_F(ProtocolMonitorHandshakes, CatchAReturnThatTakesBackTime) {
  elaborate();
  target.on_forward = [](Payload&, tlm_phase& phase, sc_time& annotated) {
    phase = tlm::END_REQ;
    annotated = sc_core::SC_ZERO_TIME;
    return tlm::TLM_UPDATED;
  };
  forward(payload, tlm::BEGIN_REQ, sc_time(1, SC_NS));
  expect_only("a transaction's time must not run backwards");
}

TEST_F(ProtocolMonitorHandshakes, CatchATargetThatWaits) {
  target.on_forward = [](auto&, auto&, auto&) {
    sc_core::wait(sc_core::SC_ZERO_TIME);
    return tlm::TLM_ACCEPTED;
  };
  simulate([this] { forward(payload, tlm::BEGIN_REQ); });
  expect_only("nb_transport_fw: time passed");
}

TEST_F(ProtocolMonitorHandshakes, CatchAnInitiatorThatWaits) {
  initiator.on_backward = [](auto&, auto&, auto&) {
    sc_core::wait(sc_core::SC_ZERO_TIME);
    return tlm::TLM_ACCEPTED;
  };
  simulate([this] {
    forward(payload, tlm::BEGIN_REQ);
    backward(payload, tlm::END_REQ);
  });
  expect_only("nb_transport_bw: time passed");
}

TEST_F(ProtocolMonitorHandshakes, CatchABlockingCallDuringTheHandshake) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  transport();
  expect_only("b_transport: the transaction is already in progress");
}

TEST_F(ProtocolMonitorHandshakes, CatchAHandshakeDuringABlockingCall) {
  elaborate();
  target.on_forward = [](Payload& received, auto&, auto&) {
    received.set_response_status(tlm::TLM_OK_RESPONSE);
    return tlm::TLM_COMPLETED;
  };
  target.on_blocking = [this](Payload& received, sc_time&) { forward(received, tlm::BEGIN_REQ); };
  transport();
  expect_only("nb_transport_fw: the transaction is already in progress");
}

}  // namespace
}  // namespace stereotlm::test
