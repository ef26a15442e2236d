#include "tests/unit/support/scripted_handshake.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::tlm_phase;

using ProtocolMonitorPhases = ScriptedHandshake;

// Correct sequences.

TEST_F(ProtocolMonitorPhases, PassAFourPhaseHandshake) {
  elaborate();
  EXPECT_EQ(forward(payload, tlm::BEGIN_REQ), tlm::TLM_ACCEPTED);
  EXPECT_EQ(backward(payload, tlm::END_REQ), tlm::TLM_ACCEPTED);
  EXPECT_EQ(backward(payload, tlm::BEGIN_RESP), tlm::TLM_ACCEPTED);
  target_returns(tlm::TLM_COMPLETED);
  EXPECT_EQ(forward(payload, tlm::END_RESP), tlm::TLM_COMPLETED);
  EXPECT_EQ(monitor.counts().nb_transactions, 1U);
  EXPECT_EQ(monitor.counts().reads, 1U);
  EXPECT_EQ(payload.get_ref_count(), 1);
}

TEST_F(ProtocolMonitorPhases, PassAHandshakeInSimulatedTime) {
  simulate([this] {
    forward(payload, tlm::BEGIN_REQ, sc_time(3, SC_NS));
    sc_core::wait(sc_time(5, SC_NS));
    backward(payload, tlm::END_REQ);
    sc_core::wait(sc_time(5, SC_NS));
    backward(payload, tlm::BEGIN_RESP, sc_time(1, SC_NS));
    sc_core::wait(sc_time(1, SC_NS));
    forward(payload, tlm::END_RESP);
  });
}

TEST_F(ProtocolMonitorPhases, PassAResponseThatSkipsEndReq) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  forward(payload, tlm::END_RESP);
}

TEST_F(ProtocolMonitorPhases, PassPhasesOnTheReturnPath) {
  elaborate();
  target_returns(tlm::TLM_UPDATED, tlm::END_REQ, sc_time(2, SC_NS));
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_UPDATED, tlm::END_RESP);
  backward(payload, tlm::BEGIN_RESP, sc_time(2, SC_NS));
}

TEST_F(ProtocolMonitorPhases, PassAResponseOnTheReturnPath) {
  elaborate();
  target_returns(tlm::TLM_UPDATED, tlm::BEGIN_RESP);
  forward(payload, tlm::BEGIN_REQ);
  target_returns(tlm::TLM_ACCEPTED);
  forward(payload, tlm::END_RESP);
}

TEST_F(ProtocolMonitorPhases, PassACompletionAtOnceAndTheTransactionsNextUse) {
  elaborate();
  target_returns(tlm::TLM_COMPLETED);
  for (int i = 0; i < 2; ++i) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    EXPECT_EQ(forward(payload, tlm::BEGIN_REQ), tlm::TLM_COMPLETED);
  }
}

TEST_F(ProtocolMonitorPhases, PassACompletionOfTheResponse) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_COMPLETED);
  backward(payload, tlm::BEGIN_RESP);
}

TEST_F(ProtocolMonitorPhases, PassPipelinedTransactions) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::END_REQ);
  forward(other, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  backward(other, tlm::END_REQ);
  forward(payload, tlm::END_RESP);
  backward(other, tlm::BEGIN_RESP);
  forward(other, tlm::END_RESP);
}

TEST_F(ProtocolMonitorPhases, PassATargetThatAnswersBeforeItReturns) {
  elaborate();
  initiator_returns(tlm::TLM_COMPLETED);
  target.on_forward = [this](Payload& received, tlm_phase&, sc_time&) {
    backward(received, tlm::BEGIN_RESP);
    return tlm::TLM_ACCEPTED;
  };
  forward(payload, tlm::BEGIN_REQ);
}

TEST_F(ProtocolMonitorPhases, TouchNoTransactionThatTheInitiatorReleasesWithItsLastAnswer) {
  class DeletingManager : public tlm::tlm_mm_interface {
   public:
    void free(Payload* freed) override { delete freed; }
  } deleting;
  auto* heap = new Payload(&deleting);
  prepare(*heap);
  heap->acquire();
  elaborate();
  forward(*heap, tlm::BEGIN_REQ);
  initiator.on_backward = [](Payload& received, tlm_phase&, sc_time&) {
    received.release();
    return tlm::TLM_COMPLETED;
  };
  backward(*heap, tlm::BEGIN_RESP);
}

// Phases out of place.

TEST_F(ProtocolMonitorPhases, CatchEndReqOnTheForwardPath) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  forward(payload, tlm::END_REQ);
  expect_only("phase END_REQ on the forward path");
}

TEST_F(ProtocolMonitorPhases, CatchBeginReqOnTheBackwardPath) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_REQ);
  expect_only("phase BEGIN_REQ from the target");
}

TEST_F(ProtocolMonitorPhases, CatchAnUninitializedPhase) {
  elaborate();
  forward(payload, tlm::UNINITIALIZED_PHASE);
  expect_only("phase UNINITIALIZED_PHASE on the forward path");
}

TEST_F(ProtocolMonitorPhases, CatchASecondEndReq) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::END_REQ);
  backward(payload, tlm::END_REQ);
  expect_only("END_REQ after the request has ended");
}

TEST_F(ProtocolMonitorPhases, CatchEndReqAfterBeginResp) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  backward(payload, tlm::END_REQ);
  expect_only("END_REQ after the request has ended");
}

TEST_F(ProtocolMonitorPhases, CatchASecondBeginRespOfOneTransaction) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  backward(payload, tlm::BEGIN_RESP);
  expect_only("a second BEGIN_RESP");
}

TEST_F(ProtocolMonitorPhases, CatchEndRespBeforeBeginResp) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  forward(payload, tlm::END_RESP);
  expect_only("END_RESP without BEGIN_RESP");
}

TEST_F(ProtocolMonitorPhases, CatchASecondEndResp) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  forward(payload, tlm::END_RESP);
  forward(payload, tlm::END_RESP);
  expect_only("END_RESP without BEGIN_RESP");
}

TEST_F(ProtocolMonitorPhases, CatchAPhaseAfterCompletion) {
  elaborate();
  target_returns(tlm::TLM_COMPLETED);
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  expect_only("phase BEGIN_RESP for a transaction that is not in progress");
}

TEST_F(ProtocolMonitorPhases, CatchAResponseToARequestThatNobodyMade) {
  elaborate();
  backward(payload, tlm::END_REQ);
  expect_only("phase END_REQ for a transaction that is not in progress");
}

TEST_F(ProtocolMonitorPhases, CatchASecondBeginReqOfOneTransaction) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::END_REQ);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("BEGIN_REQ for a transaction that is already in progress");
}

// Exclusion.

TEST_F(ProtocolMonitorPhases, CatchASecondRequestBeforeTheFirstEnded) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  forward(other, tlm::BEGIN_REQ);
  expect_only("one request at a time");
}

TEST_F(ProtocolMonitorPhases, CatchASecondResponseBeforeTheFirstEnded) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::END_REQ);
  forward(other, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  backward(other, tlm::BEGIN_RESP);
  expect_only("one response at a time");
}

TEST_F(ProtocolMonitorPhases, CatchAReturnedResponseBeforeTheFirstEnded) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  target_returns(tlm::TLM_UPDATED, tlm::BEGIN_RESP);
  forward(other, tlm::BEGIN_REQ);
  expect_only("one response at a time");
}

}  // namespace
}  // namespace stereotlm::test
