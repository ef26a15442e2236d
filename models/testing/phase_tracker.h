#pragma once

#include <optional>
#include <systemc>
#include <tlm>
#include <unordered_map>

#include "models/testing/payload_rules.h"

namespace stereotlm::test {

// Checks the four-phase handshake of the base protocol on one link (IEEE 1666-2011, 15.2): the order and
// direction of phases, return values, the two exclusion rules, and times that must not decrease. After a
// broken rule it continues from the last call, so that one mistake is reported once.
class PhaseTracker {
 public:
  explicit PhaseTracker(const ProtocolOptions& options) : options_(options) {}  // on a new link

  // The arguments of a call of nb_transport.
  struct Call {
    tlm::tlm_phase phase;   // BEGIN_REQ and the others
    sc_core::sc_time time;  // sc_time_stamp() plus the annotated delay
  };
  // `answer`: phase and time as the callee returns them.
  Problems forward_call(const tlm::tlm_generic_payload& payload, const Call& call);
  Problems forward_return(const tlm::tlm_generic_payload& payload, const Call& call, const Call& answer,
                          tlm::tlm_sync_enum status);
  Problems backward_call(const tlm::tlm_generic_payload& payload, const Call& call);
  Problems backward_return(const tlm::tlm_generic_payload& payload, const Call& call, const Call& answer,
                           tlm::tlm_sync_enum status);

  bool in_progress(const tlm::tlm_generic_payload& payload) const {  // whether it has no END_RESP yet
    return transactions_.count(&payload) != 0;
  }
  Problems open_problems() const;  // one of each transaction in progress, at the end of the simulation

 private:
  enum class State { kRequest, kRequestEnded, kResponse };
  struct Transaction {
    State state;
    sc_core::sc_time begin;  // of BEGIN_REQ
    sc_core::sc_time time;   // of the last call or return
    PayloadSnapshot sent;
    std::optional<ResponseSnapshot> answered = {};
    bool spoilt = false;    // a change is reported once
    unsigned extended = 0;  // the ignorable phase that came last
  };
  using Payload = tlm::tlm_generic_payload;

  Transaction* find(const Payload& payload);
  void begin_request(const Payload& payload, const sc_core::sc_time& time, Problems& problems);
  void answer_phase(const Payload& payload, Transaction& transaction, const tlm::tlm_phase& phase,
                    Problems& problems);
  void advance(Transaction& transaction, const sc_core::sc_time& time, Problems& problems) const;
  void finish(const Payload& payload);
  void check_unchanged(const Payload& payload, Transaction& transaction, Problems& problems) const;
  void extended_phase(const Payload& payload, const Call& call, Problems& problems);
  Problems extended_return(const Payload& payload, const Call& answer, tlm::tlm_sync_enum status,
                           bool forward);

  ProtocolOptions options_;
  std::unordered_map<const Payload*, Transaction> transactions_;
  const Payload* request_ = nullptr;   // BEGIN_REQ sent, not yet ended
  const Payload* response_ = nullptr;  // BEGIN_RESP sent, not yet ended
};

}  // namespace stereotlm::test
