#include "tests/unit/support/scripted_handshake.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::tlm_phase;
using tlm::tlm_sync_enum;

using ProtocolMonitorReturns = ScriptedHandshake;

TEST_F(ProtocolMonitorReturns, CatchAnAcceptedCallThatChangesThePhase) {
  elaborate();
  target_returns(tlm::TLM_ACCEPTED, tlm::END_REQ);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("TLM_ACCEPTED with phase END_REQ");
}

TEST_F(ProtocolMonitorReturns, CatchAnAcceptedCallThatChangesTheDelay) {
  elaborate();
  target_returns(tlm::TLM_ACCEPTED, tlm::UNINITIALIZED_PHASE, sc_time(1, SC_NS));
  forward(payload, tlm::BEGIN_REQ);
  expect_only("TLM_ACCEPTED with another delay");
}

TEST_F(ProtocolMonitorReturns, CatchAnUpdateWithoutANewPhase) {
  elaborate();
  target_returns(tlm::TLM_UPDATED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("phase BEGIN_REQ from the target");
}

TEST_F(ProtocolMonitorReturns, CatchAnUpdateOfTheLastPhase) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  target_returns(tlm::TLM_UPDATED);
  forward(payload, tlm::END_RESP);
  expect_only("TLM_UPDATED for END_RESP");
}

TEST_F(ProtocolMonitorReturns, CatchAnInitiatorThatAnswersEndReq) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_COMPLETED);
  backward(payload, tlm::END_REQ);
  expect_only("END_REQ: only TLM_ACCEPTED may be returned");
}

TEST_F(ProtocolMonitorReturns, CatchAnInitiatorThatAnswersBeginRespWithAnotherPhase) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_UPDATED, tlm::END_REQ);
  backward(payload, tlm::BEGIN_RESP);
  expect_only("TLM_UPDATED with phase END_REQ for BEGIN_RESP");
}

TEST_F(ProtocolMonitorReturns, CatchAnUnknownReturnValueOfTheTarget) {
  elaborate();
  target_returns(static_cast<tlm_sync_enum>(3));
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw returned 3");
}

TEST_F(ProtocolMonitorReturns, CatchAnUnknownReturnValueOfTheInitiator) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(static_cast<tlm_sync_enum>(3));
  backward(payload, tlm::END_REQ);
  expect_only("nb_transport_bw returned 3");
}

TEST_F(ProtocolMonitorReturns, CatchAPhaseReturnedAfterTheTransactionWasCompletedInside) {
  elaborate();
  initiator_returns(tlm::TLM_COMPLETED);
  target.on_forward = [this](Payload& received, tlm_phase& phase, sc_time&) {
    backward(received, tlm::BEGIN_RESP);
    phase = tlm::END_REQ;
    return tlm::TLM_UPDATED;
  };
  forward(payload, tlm::BEGIN_REQ);
  expect_only("a phase returned for a transaction that was complete");
}

}  // namespace
}  // namespace stereotlm::test
