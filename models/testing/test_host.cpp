#include "models/testing/test_host.h"

namespace stereotlm::test {

// Not inline: the compiler then makes the class's tables for virtual functions only here. Those of g++ and of
// clang++ cannot stand in for each other.
tlm::tlm_sync_enum TestHost::nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  for (Transaction& transaction : transactions_) {
    if (&transaction.payload == &payload) record(transaction, delay);
  }
  answered_.notify(delay);
  if (ending == Ending::kAccepted) return tlm::TLM_ACCEPTED;
  payload.release();
  if (ending == Ending::kCompleted) return tlm::TLM_COMPLETED;
  phase = tlm::END_RESP;
  return tlm::TLM_UPDATED;
}

}  // namespace stereotlm::test
