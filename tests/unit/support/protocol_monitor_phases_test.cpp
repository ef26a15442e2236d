#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using Payload = tlm::tlm_generic_payload;
using tlm::tlm_phase;
using tlm::tlm_sync_enum;

// Two correct managed transactions, acquired once each, and calls in both directions.
class ProtocolMonitorPhases : public ScriptedLink {
 protected:
  ProtocolMonitorPhases() {
    for (auto* managed : {&payload, &other}) {
      prepare(*managed);
      managed->set_mm(&manager);
      managed->acquire();
    }
  }

  // The next forward (backward) call is answered with this.
  void target_returns(tlm_sync_enum status, tlm_phase phase = tlm::UNINITIALIZED_PHASE, sc_time added = {}) {
    target.on_forward = [=](Payload& received, tlm_phase& returned, sc_time& annotated) {
      if (phase != tlm::UNINITIALIZED_PHASE) returned = phase;
      if (status == tlm::TLM_COMPLETED || phase == tlm::BEGIN_RESP) {
        received.set_response_status(tlm::TLM_OK_RESPONSE);
      }
      annotated += added;
      return status;
    };
  }
  void initiator_returns(tlm_sync_enum status, tlm_phase phase = tlm::UNINITIALIZED_PHASE) {
    initiator.on_backward = [=](Payload&, tlm_phase& returned, sc_time&) {
      if (phase != tlm::UNINITIALIZED_PHASE) returned = phase;
      return status;
    };
  }

  tlm_sync_enum forward(Payload& sent, tlm_phase phase, sc_time annotated = {}) {
    return initiator.socket->nb_transport_fw(sent, phase, annotated);
  }
  tlm_sync_enum backward(Payload& sent, tlm_phase phase, sc_time annotated = {}) {
    if (phase == tlm::BEGIN_RESP) sent.set_response_status(tlm::TLM_OK_RESPONSE);
    return target.socket->nb_transport_bw(sent, phase, annotated);
  }

  CountingManager manager;
  Payload other;
};

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

// Return values.

TEST_F(ProtocolMonitorPhases, CatchAnAcceptedCallThatChangesThePhase) {
  elaborate();
  target_returns(tlm::TLM_ACCEPTED, tlm::END_REQ);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("TLM_ACCEPTED with phase END_REQ");
}

TEST_F(ProtocolMonitorPhases, CatchAnAcceptedCallThatChangesTheDelay) {
  elaborate();
  target_returns(tlm::TLM_ACCEPTED, tlm::UNINITIALIZED_PHASE, sc_time(1, SC_NS));
  forward(payload, tlm::BEGIN_REQ);
  expect_only("TLM_ACCEPTED with another delay");
}

TEST_F(ProtocolMonitorPhases, CatchAnUpdateWithoutANewPhase) {
  elaborate();
  target_returns(tlm::TLM_UPDATED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("phase BEGIN_REQ from the target");
}

TEST_F(ProtocolMonitorPhases, CatchAnUpdateOfTheLastPhase) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  backward(payload, tlm::BEGIN_RESP);
  target_returns(tlm::TLM_UPDATED);
  forward(payload, tlm::END_RESP);
  expect_only("TLM_UPDATED for END_RESP");
}

TEST_F(ProtocolMonitorPhases, CatchAnInitiatorThatAnswersEndReq) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_COMPLETED);
  backward(payload, tlm::END_REQ);
  expect_only("END_REQ: only TLM_ACCEPTED may be returned");
}

TEST_F(ProtocolMonitorPhases, CatchAnInitiatorThatAnswersBeginRespWithAnotherPhase) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(tlm::TLM_UPDATED, tlm::END_REQ);
  backward(payload, tlm::BEGIN_RESP);
  expect_only("TLM_UPDATED with phase END_REQ for BEGIN_RESP");
}

TEST_F(ProtocolMonitorPhases, CatchAnUnknownReturnValueOfTheTarget) {
  elaborate();
  target_returns(static_cast<tlm_sync_enum>(3));
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw returned 3");
}

TEST_F(ProtocolMonitorPhases, CatchAnUnknownReturnValueOfTheInitiator) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  initiator_returns(static_cast<tlm_sync_enum>(3));
  backward(payload, tlm::END_REQ);
  expect_only("nb_transport_bw returned 3");
}

TEST_F(ProtocolMonitorPhases, CatchAPhaseReturnedAfterTheTransactionWasCompletedInside) {
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

// The payload.

TEST_F(ProtocolMonitorPhases, CatchAWrongRequest) {
  elaborate();
  payload.set_streaming_width(0);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: streaming width = 0");
}

TEST_F(ProtocolMonitorPhases, CatchAResponseWithoutStatus) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  tlm_phase phase = tlm::BEGIN_RESP;
  target.socket->nb_transport_bw(payload, phase, delay);
  expect_only("nb_transport_bw: response status = 0");
}

TEST_F(ProtocolMonitorPhases, CatchACompletionWithoutStatus) {
  elaborate();
  target.on_forward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: response status = 0");
}

TEST_F(ProtocolMonitorPhases, CatchATargetThatChangesTheAddressBeforeItReturns) {
  elaborate();
  target.on_forward = [](Payload& received, auto&, auto&) {
    received.set_address(0);
    received.set_response_status(tlm::TLM_OK_RESPONSE);
    return tlm::TLM_COMPLETED;
  };
  forward(payload, tlm::BEGIN_REQ);
  expect_only("nb_transport_fw: address changed");
}

TEST_F(ProtocolMonitorPhases, CatchAnInitiatorThatChangesWrittenDataBeforeTheResponse) {
  elaborate();
  payload.set_write();
  forward(payload, tlm::BEGIN_REQ);
  data[3] = 1;
  initiator_returns(tlm::TLM_ACCEPTED);
  backward(payload, tlm::END_REQ);
  expect_only("nb_transport_bw: data array of a write changed");
}

TEST_F(ProtocolMonitorPhases, CatchATransactionWithoutMemoryManager) {
  elaborate();
  payload.set_mm(nullptr);
  target_returns(tlm::TLM_COMPLETED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("no memory manager");
}

TEST_F(ProtocolMonitorPhases, CatchATransactionThatNobodyAcquired) {
  elaborate();
  payload.release();
  target_returns(tlm::TLM_COMPLETED);
  forward(payload, tlm::BEGIN_REQ);
  expect_only("reference count = 0");
}

// Time, and the other transport.

TEST_F(ProtocolMonitorPhases, CatchAResponseBeforeItsRequest) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ, sc_time(10, SC_NS));
  backward(payload, tlm::BEGIN_RESP, sc_time(9, SC_NS));
  expect_only("time 9 ns after 10 ns");
}

TEST_F(ProtocolMonitorPhases, PassAResponseAtTheTimeOfItsRequest) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ, sc_time(10, SC_NS));
  backward(payload, tlm::BEGIN_RESP, sc_time(10, SC_NS));
}

TEST_F(ProtocolMonitorPhases, CatchAReturnThatTakesBackTime) {
  elaborate();
  target.on_forward = [](Payload&, tlm_phase& phase, sc_time& annotated) {
    phase = tlm::END_REQ;
    annotated = sc_core::SC_ZERO_TIME;
    return tlm::TLM_UPDATED;
  };
  forward(payload, tlm::BEGIN_REQ, sc_time(1, SC_NS));
  expect_only("a transaction's time must not run backwards");
}

TEST_F(ProtocolMonitorPhases, CatchATargetThatWaits) {
  target.on_forward = [](auto&, auto&, auto&) {
    sc_core::wait(sc_core::SC_ZERO_TIME);
    return tlm::TLM_ACCEPTED;
  };
  simulate([this] { forward(payload, tlm::BEGIN_REQ); });
  expect_only("nb_transport_fw: time passed");
}

TEST_F(ProtocolMonitorPhases, CatchAnInitiatorThatWaits) {
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

TEST_F(ProtocolMonitorPhases, CatchABlockingCallDuringTheHandshake) {
  elaborate();
  forward(payload, tlm::BEGIN_REQ);
  transport();
  expect_only("b_transport: the transaction is already in progress");
}

TEST_F(ProtocolMonitorPhases, CatchAHandshakeDuringABlockingCall) {
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
