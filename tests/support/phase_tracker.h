#pragma once

#include <optional>
#include <systemc>
#include <tlm>
#include <unordered_map>

#include "tests/support/payload_rules.h"

namespace stereotlm::test {

// The four-phase handshake of the base protocol on one link (IEEE 1666-2011, 15.2): which phase may follow
// which in which direction, what a call may return, the two exclusion rules, and time that does not run
// backwards. After a broken rule it follows what was said last, so that one mistake is told once.
class PhaseTracker {
 public:
  explicit PhaseTracker(const ProtocolOptions& options) : options_(options) {}

  // `time` is sc_time_stamp() plus the annotated delay. A return is told with the phase and time of its call.
  struct Call {
    tlm::tlm_phase phase;
    sc_core::sc_time time;
  };
  Problems forward_call(const tlm::tlm_generic_payload& payload, const Call& call);
  Problems forward_return(const tlm::tlm_generic_payload& payload, const Call& call, const Call& answer,
                          tlm::tlm_sync_enum status);
  Problems backward_call(const tlm::tlm_generic_payload& payload, const Call& call);
  Problems backward_return(const tlm::tlm_generic_payload& payload, const Call& call, const Call& answer,
                           tlm::tlm_sync_enum status);

  bool in_progress(const tlm::tlm_generic_payload& payload) const {
    return transactions_.count(&payload) != 0;
  }

 private:
  enum class State { kRequest, kRequestEnded, kResponse };
  struct Transaction {
    State state;
    sc_core::sc_time time;  // of the last call or return
    PayloadSnapshot sent;
  };
  using Payload = tlm::tlm_generic_payload;

  Transaction* find(const Payload& payload);
  void begin_request(const Payload& payload, const sc_core::sc_time& time, Problems& problems);
  void answer_phase(const Payload& payload, Transaction& transaction, const tlm::tlm_phase& phase,
                    Problems& problems);
  void advance(Transaction& transaction, const sc_core::sc_time& time, Problems& problems) const;
  void finish(const Payload& payload);
  void check_unchanged(const Payload& payload, const Transaction& transaction, Problems& problems) const;

  ProtocolOptions options_;
  std::unordered_map<const Payload*, Transaction> transactions_;
  const Payload* request_ = nullptr;   // BEGIN_REQ sent, not yet ended
  const Payload* response_ = nullptr;  // BEGIN_RESP sent, not yet ended
};

}  // namespace stereotlm::test
