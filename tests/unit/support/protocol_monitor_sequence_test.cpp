#include <vector>

#include "tests/unit/support/scripted_link.h"

// The four-phase handshake of the base protocol under a monitor.
namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::BEGIN_REQ;
using tlm::BEGIN_RESP;
using tlm::END_REQ;
using tlm::END_RESP;
using tlm::tlm_phase;
using tlm::UNINITIALIZED_PHASE;
using Payload = tlm::tlm_generic_payload;

constexpr auto kUnknownStatus = static_cast<tlm::tlm_sync_enum>(3);

// One call of nb_transport, and how the other end answers it.
struct Step {
  bool forward = true;
  tlm::tlm_phase_enum phase = BEGIN_REQ;
  sc_time delay = sc_core::SC_ZERO_TIME;
  bool of_other = false;  // the second transaction
  tlm::tlm_sync_enum status = tlm::TLM_ACCEPTED;
  tlm::tlm_phase_enum returned = UNINITIALIZED_PHASE;  // left as it is
  sc_time added = sc_core::SC_ZERO_TIME;

  Step after(int ns) {
    delay = sc_time(ns, SC_NS);
    return *this;
  }
  Step other() {
    of_other = true;
    return *this;
  }
  Step returns(tlm::tlm_sync_enum answer, tlm::tlm_phase_enum with = UNINITIALIZED_PHASE, int added_ns = 0) {
    status = answer;
    returned = with;
    added = sc_time(added_ns, SC_NS);
    return *this;
  }
};

Step forward(tlm::tlm_phase_enum phase) { return {true, phase}; }
Step backward(tlm::tlm_phase_enum phase) { return {false, phase}; }

void take(const Step& step, ScriptedLink& link) {
  const auto answer = [&step](Payload& received, tlm_phase& phase, sc_time& annotated) {
    if (step.returned != UNINITIALIZED_PHASE) phase = step.returned;
    const bool responds = step.status == tlm::TLM_COMPLETED || step.returned == BEGIN_RESP;
    if (step.forward && responds) received.set_response_status(tlm::TLM_OK_RESPONSE);
    annotated += step.added;
    return step.status;
  };
  Payload& payload = step.of_other ? link.other : link.payload;
  if (step.forward) {
    link.target.on_forward = answer;
    EXPECT_EQ(link.forward(payload, step.phase, step.delay), step.status);
  } else {
    link.initiator.on_backward = answer;
    EXPECT_EQ(link.backward(payload, step.phase, step.delay), step.status);
  }
}

// The steps on two transactions that have been acquired once each.
Exchange steps(const char* name, const char* violation, const std::vector<Step>& all) {
  return {name, violation, [all](ScriptedLink& link) {
            link.manage();
            for (const Step& step : all) take(step, link);
            EXPECT_EQ(link.payload.get_ref_count(), 1);
          }};
}

class ProtocolMonitorSequence : public ExchangeTest {};
TEST_P(ProtocolMonitorSequence, GivesItsViolationAndNoOther) { expect_its_violation(); }

INSTANTIATE_TEST_SUITE_P(
    Correct, ProtocolMonitorSequence,
    testing::Values(steps("FourPhases", nullptr,
                          {forward(BEGIN_REQ), backward(END_REQ), backward(BEGIN_RESP),
                           forward(END_RESP).returns(tlm::TLM_COMPLETED)}),
                    steps("ResponseWithoutEndReq", nullptr,
                          {forward(BEGIN_REQ), backward(BEGIN_RESP), forward(END_RESP)}),
                    steps("PhasesOnTheReturnPath", nullptr,
                          {forward(BEGIN_REQ).returns(tlm::TLM_UPDATED, END_REQ, 2),
                           backward(BEGIN_RESP).after(2).returns(tlm::TLM_UPDATED, END_RESP)}),
                    steps("ResponseOnTheReturnPath", nullptr,
                          {forward(BEGIN_REQ).returns(tlm::TLM_UPDATED, BEGIN_RESP), forward(END_RESP)}),
                    steps("CompletionAtOnce", nullptr, {forward(BEGIN_REQ).returns(tlm::TLM_COMPLETED)}),
                    steps("CompletionOfTheResponse", nullptr,
                          {forward(BEGIN_REQ), backward(BEGIN_RESP).returns(tlm::TLM_COMPLETED)}),
                    steps("ResponseAtTheTimeOfItsRequest", nullptr,
                          {forward(BEGIN_REQ).after(10), backward(BEGIN_RESP).after(10)}),
                    steps("PipelinedTransactions", nullptr,
                          {forward(BEGIN_REQ), backward(END_REQ), forward(BEGIN_REQ).other(),
                           backward(BEGIN_RESP), backward(END_REQ).other(), forward(END_RESP),
                           backward(BEGIN_RESP).other(), forward(END_RESP).other()})),
    ExchangeTest::name);

INSTANTIATE_TEST_SUITE_P(
    Wrong, ProtocolMonitorSequence,
    testing::Values(
        steps("EndReqOnTheForwardPath", "phase END_REQ on the forward path",
              {forward(BEGIN_REQ), forward(END_REQ)}),
        steps("BeginReqOnTheBackwardPath", "phase BEGIN_REQ from the target",
              {forward(BEGIN_REQ), backward(BEGIN_REQ)}),
        steps("UninitializedPhase", "phase UNINITIALIZED_PHASE on the forward path",
              {forward(UNINITIALIZED_PHASE)}),
        steps("SecondEndReq", "END_REQ after the request has ended",
              {forward(BEGIN_REQ), backward(END_REQ), backward(END_REQ)}),
        steps("EndReqAfterBeginResp", "END_REQ after the request has ended",
              {forward(BEGIN_REQ), backward(BEGIN_RESP), backward(END_REQ)}),
        steps("SecondBeginResp", "a second BEGIN_RESP",
              {forward(BEGIN_REQ), backward(BEGIN_RESP), backward(BEGIN_RESP)}),
        steps("EndRespBeforeBeginResp", "END_RESP without BEGIN_RESP",
              {forward(BEGIN_REQ), forward(END_RESP)}),
        steps("SecondEndResp", "END_RESP without BEGIN_RESP",
              {forward(BEGIN_REQ), backward(BEGIN_RESP), forward(END_RESP), forward(END_RESP)}),
        steps("PhaseAfterCompletion", "phase BEGIN_RESP for a transaction that is not in progress",
              {forward(BEGIN_REQ).returns(tlm::TLM_COMPLETED), backward(BEGIN_RESP)}),
        steps("PhaseWithoutRequest", "phase END_REQ for a transaction that is not in progress",
              {backward(END_REQ)}),
        steps("SecondBeginReq", "BEGIN_REQ for a transaction that is already in progress",
              {forward(BEGIN_REQ), backward(END_REQ), forward(BEGIN_REQ)}),
        steps("ResponseEarlierThanItsRequest", "time 9 ns after 10 ns",
              {forward(BEGIN_REQ).after(10), backward(BEGIN_RESP).after(9)}),
        steps("SecondRequest", "one request at a time", {forward(BEGIN_REQ), forward(BEGIN_REQ).other()}),
        steps("SecondResponse", "one response at a time",
              {forward(BEGIN_REQ), backward(END_REQ), forward(BEGIN_REQ).other(), backward(BEGIN_RESP),
               backward(BEGIN_RESP).other()}),
        steps("SecondResponseReturned", "one response at a time",
              {forward(BEGIN_REQ), backward(BEGIN_RESP),
               forward(BEGIN_REQ).other().returns(tlm::TLM_UPDATED, BEGIN_RESP)}),
        steps("AcceptedWithAnotherPhase", "TLM_ACCEPTED with phase END_REQ",
              {forward(BEGIN_REQ).returns(tlm::TLM_ACCEPTED, END_REQ)}),
        steps("AcceptedWithAnotherDelay", "TLM_ACCEPTED with another delay",
              {forward(BEGIN_REQ).returns(tlm::TLM_ACCEPTED, UNINITIALIZED_PHASE, 1)}),
        steps("UpdatedWithoutNewPhase", "phase BEGIN_REQ from the target",
              {forward(BEGIN_REQ).returns(tlm::TLM_UPDATED)}),
        steps("UpdatedAfterTheLastPhase", "TLM_UPDATED for END_RESP",
              {forward(BEGIN_REQ), backward(BEGIN_RESP), forward(END_RESP).returns(tlm::TLM_UPDATED)}),
        steps("AnswerToEndReq", "END_REQ: only TLM_ACCEPTED may be returned",
              {forward(BEGIN_REQ), backward(END_REQ).returns(tlm::TLM_COMPLETED)}),
        steps("AnswerToBeginRespWithAnotherPhase", "TLM_UPDATED with phase END_REQ for BEGIN_RESP",
              {forward(BEGIN_REQ), backward(BEGIN_RESP).returns(tlm::TLM_UPDATED, END_REQ)}),
        steps("UnknownStatusOfTheTarget", "nb_transport_fw returned 3",
              {forward(BEGIN_REQ).returns(kUnknownStatus)}),
        steps("UnknownStatusOfTheInitiator", "nb_transport_bw returned 3",
              {forward(BEGIN_REQ), backward(END_REQ).returns(kUnknownStatus)})),
    ExchangeTest::name);

class ProtocolMonitorHandshake : public ScriptedLink {
 protected:
  ProtocolMonitorHandshake() { manage(); }
};

TEST_F(ProtocolMonitorHandshake, PassesInSimulatedTimeAndIsCounted) {
  simulate([this] {
    forward(payload, BEGIN_REQ, sc_time(3, SC_NS));
    sc_core::wait(sc_time(5, SC_NS));
    backward(payload, END_REQ);
    sc_core::wait(sc_time(5, SC_NS));
    backward(payload, BEGIN_RESP, sc_time(1, SC_NS));
    sc_core::wait(sc_time(1, SC_NS));
    forward(payload, END_RESP);
  });
  EXPECT_EQ(monitor.counts().nb_transactions, 1U);
  EXPECT_EQ(monitor.counts().reads, 1U);
}

TEST_F(ProtocolMonitorHandshake, PassesTheNextUseOfACompletedTransaction) {
  elaborate();
  for (int i = 0; i < 2; ++i) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    take(Step{}.returns(tlm::TLM_COMPLETED), *this);
  }
}

TEST_F(ProtocolMonitorHandshake, PassesATargetThatAnswersBeforeItReturns) {
  elaborate();
  initiator.on_backward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
  target.on_forward = [this](Payload& received, tlm_phase&, sc_time&) {
    backward(received, BEGIN_RESP);
    return tlm::TLM_ACCEPTED;
  };
  forward(payload, BEGIN_REQ);
}

TEST_F(ProtocolMonitorHandshake, CatchesAPhaseReturnedAfterTheTransactionWasCompletedInside) {
  elaborate();
  initiator.on_backward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
  target.on_forward = [this](Payload& received, tlm_phase& phase, sc_time&) {
    backward(received, BEGIN_RESP);
    phase = END_REQ;
    return tlm::TLM_UPDATED;
  };
  forward(payload, BEGIN_REQ);
  expect_only("a phase returned for a transaction that was complete");
}

TEST_F(ProtocolMonitorHandshake, DoesNotTouchATransactionThatTheInitiatorReleasesWithItsLastAnswer) {
  // Spoils what is freed, so that the monitor reports a change if it still looks at it.
  class SpoilingManager : public tlm::tlm_mm_interface {
   public:
    void free(Payload* payload) override {
      ++freed;
      payload->set_address(~payload->get_address());
      payload->set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    }
    int freed = 0;
  } spoiling;
  Payload released(&spoiling);
  prepare(released);
  released.acquire();
  elaborate();
  forward(released, BEGIN_REQ);
  initiator.on_backward = [&spoiling](Payload& received, tlm_phase&, sc_time&) {
    received.release();
    EXPECT_EQ(spoiling.freed, 0) << "the monitor holds it until it has looked at it";
    return tlm::TLM_COMPLETED;
  };
  backward(released, BEGIN_RESP);
  EXPECT_EQ(spoiling.freed, 1);
}

// Violations during a handshake: a payload that is wrong or changes, a forbidden call, time that passes or
// runs backwards. Each is reported once.
class ProtocolMonitorMistake : public ExchangeTest {
 protected:
  ProtocolMonitorMistake() { manage(); }
};
TEST_P(ProtocolMonitorMistake, IsReportedOnce) { expect_its_violation(); }

auto complete = [](Payload& received, auto&, auto&) {
  received.set_response_status(tlm::TLM_OK_RESPONSE);
  return tlm::TLM_COMPLETED;
};
auto wait_a_delta = [](auto&, auto&, auto&) {
  sc_core::wait(sc_core::SC_ZERO_TIME);
  return tlm::TLM_ACCEPTED;
};

INSTANTIATE_TEST_SUITE_P(
    Handshake, ProtocolMonitorMistake,
    testing::Values(Exchange{"WrongRequest", "nb_transport_fw: streaming width = 0",
                             [](auto& link) {
                               link.payload.set_streaming_width(0);
                               link.forward(link.payload, BEGIN_REQ);
                             }},
                    Exchange{"ResponseWithoutStatus", "nb_transport_bw: response status = 0",
                             [](auto& link) {
                               tlm_phase phase = BEGIN_RESP;
                               link.forward(link.payload, BEGIN_REQ);
                               link.target.socket->nb_transport_bw(link.payload, phase, link.delay);
                             }},
                    Exchange{"CompletionWithoutStatus", "nb_transport_fw: response status = 0",
                             [](auto& link) {
                               link.target.on_forward = [](auto&, auto&, auto&) {
                                 return tlm::TLM_COMPLETED;
                               };
                               link.forward(link.payload, BEGIN_REQ);
                             }},
                    Exchange{"TargetThatChangesTheAddressBeforeItReturns", "nb_transport_fw: address changed",
                             [](auto& link) {
                               link.target.on_forward = [](Payload& received, auto& phase, auto& annotated) {
                                 received.set_address(0);
                                 return complete(received, phase, annotated);
                               };
                               link.forward(link.payload, BEGIN_REQ);
                             }},
                    Exchange{"ReturnThatTakesBackTime", "a transaction's time must not run backwards",
                             [](auto& link) {
                               link.target.on_forward = [](auto&, tlm_phase& phase, sc_time& annotated) {
                                 phase = END_REQ;
                                 annotated = sc_core::SC_ZERO_TIME;
                                 return tlm::TLM_UPDATED;
                               };
                               link.forward(link.payload, BEGIN_REQ, sc_time(1, SC_NS));
                             }},
                    Exchange{"InitiatorThatChangesWrittenData",
                             "nb_transport_bw: data array of a write changed",
                             [](auto& link) {
                               link.payload.set_write();
                               link.forward(link.payload, BEGIN_REQ);
                               link.data[3] = 1;
                               link.backward(link.payload, END_REQ);
                             }},
                    Exchange{"NoMemoryManager", "no memory manager",
                             [](auto& link) {
                               link.payload.set_mm(nullptr);
                               link.target.on_forward = complete;
                               link.forward(link.payload, BEGIN_REQ);
                             }},
                    Exchange{"NoReference", "reference count = 0",
                             [](auto& link) {
                               link.payload.release();
                               link.target.on_forward = complete;
                               link.forward(link.payload, BEGIN_REQ);
                             }},
                    Exchange{"TargetThatWaits", "nb_transport_fw: time passed",
                             [](auto& link) {
                               link.target.on_forward = wait_a_delta;
                               link.simulate([&link] { link.forward(link.payload, BEGIN_REQ); });
                             }},
                    Exchange{"InitiatorThatWaits", "nb_transport_bw: time passed",
                             [](auto& link) {
                               link.initiator.on_backward = wait_a_delta;
                               link.forward(link.payload, BEGIN_REQ);
                               link.simulate([&link] { link.backward(link.payload, END_REQ); });
                             }},
                    Exchange{"BlockingCallMeanwhile", "b_transport: the transaction is already in progress",
                             [](auto& link) {
                               link.forward(link.payload, BEGIN_REQ);
                               link.transport();
                             }},
                    Exchange{"DuringABlockingCall", "nb_transport_fw: the transaction is already in progress",
                             [](auto& link) {
                               link.target.on_forward = complete;
                               link.target.on_blocking = [&link](Payload& received, auto&) {
                                 link.forward(received, BEGIN_REQ);
                               };
                               link.transport();
                             }}),
    ExchangeTest::name);

}  // namespace
}  // namespace stereotlm::test
