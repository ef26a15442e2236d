#include "models/testing/test_host.h"

namespace stereotlm::test {

TestHost::Transaction::Transaction(tlm::tlm_command command, std::uint64_t address,
                                   std::vector<std::uint32_t> data)
    : words(std::move(data)) {
  const auto bytes = static_cast<unsigned>(words.size() * 4);
  set_command(command);
  set_address(address);
  set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  set_data_length(bytes);
  set_streaming_width(bytes);
}

TestHost::Answer TestHost::access(tlm::tlm_command command, std::uint64_t address,
                                  std::vector<std::uint32_t> words) {
  request(command, address, std::move(words));
  const Transaction& transaction = transactions_.back();
  while (!transaction.answer) sc_core::wait(answered_);
  const Answer answer = *transaction.answer;
  if (answer.at > sc_core::sc_time_stamp()) sc_core::wait(answer.at - sc_core::sc_time_stamp());
  return answer;
}

unsigned TestHost::debug_write(std::uint64_t address, const std::vector<std::uint32_t>& words) {
  Transaction transaction(tlm::TLM_WRITE_COMMAND, address, words);
  return socket->transport_dbg(transaction);
}

std::vector<std::uint32_t> TestHost::debug_read(std::uint64_t address, std::size_t count) {
  Transaction transaction(tlm::TLM_READ_COMMAND, address, std::vector<std::uint32_t>(count));
  transaction.words.resize(socket->transport_dbg(transaction) / 4);
  return transaction.words;
}

bool TestHost::dmi(std::uint64_t address, tlm::tlm_dmi& dmi) {
  Transaction transaction(tlm::TLM_READ_COMMAND, address, {});
  dmi.init();
  return socket->get_direct_mem_ptr(transaction, dmi);
}

TestHost::Answer TestHost::block(tlm::tlm_command command, std::uint64_t address,
                                 std::vector<std::uint32_t> words, sc_core::sc_time delay) {
  Transaction transaction(command, address, std::move(words));
  socket->b_transport(transaction, delay);
  return answer_of(transaction, delay);
}

TestHost::Answer TestHost::answer_of(const Transaction& transaction, const sc_core::sc_time& delay) {
  return {transaction.get_response_status(), transaction.words.front(), sc_core::sc_time_stamp() + delay,
          transaction.words};
}

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
