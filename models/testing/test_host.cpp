#include "models/testing/test_host.h"

namespace stereotlm::test {

tlm::tlm_sync_enum TestHost::request(tlm::tlm_command command, std::uint64_t address,
                                     std::vector<std::uint32_t> words, sc_core::sc_time delay) {
  Transaction& transaction = transactions_.emplace_back(command, address, std::move(words));
  transaction.set_mm(&manager_);
  transaction.acquire();
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  const tlm::tlm_sync_enum status = socket->nb_transport_fw(transaction, phase, delay);
  const bool has_response =
      status == tlm::TLM_COMPLETED || (status == tlm::TLM_UPDATED && phase == tlm::BEGIN_RESP);
  if (has_response) record(transaction, delay);
  if (has_response && status == tlm::TLM_UPDATED && ending != Ending::kAccepted) end_response();
  return status;
}

tlm::tlm_sync_enum TestHost::end_response() {
  tlm::tlm_phase phase = tlm::END_RESP;
  sc_core::sc_time delay =
      answers.empty() ? sc_core::sc_time() : answers.back().at - sc_core::sc_time_stamp();
  Transaction& transaction = transactions_.back();
  const auto status = socket->nb_transport_fw(transaction, phase, delay);
  transaction.release();
  return status;
}

void TestHost::record(tlm::tlm_generic_payload& payload, const sc_core::sc_time& delay) {
  auto& transaction = static_cast<Transaction&>(payload);
  transaction.answer = answer_of(transaction, delay);
  answers.push_back(*transaction.answer);
}

// Not inline: the compiler then makes the class's tables for virtual functions only here. Those of g++ and of
// clang++ cannot stand in for each other.
tlm::tlm_sync_enum TestHost::nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  record(payload, delay);
  answered_.notify(delay);
  if (ending == Ending::kAccepted) return tlm::TLM_ACCEPTED;
  payload.release();
  if (ending == Ending::kCompleted) return tlm::TLM_COMPLETED;
  phase = tlm::END_RESP;
  return tlm::TLM_UPDATED;
}

}  // namespace stereotlm::test
