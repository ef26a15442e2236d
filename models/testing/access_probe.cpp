#include "models/testing/access_probe.h"

#include <cstring>
#include <utility>

namespace stereotlm::test {

AccessProbe::AccessProbe(const sc_core::sc_module_name& name) : sc_module(name) {
  from_initiator.bind(*this);
  to_target.bind(*this);
}

void AccessProbe::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const std::uint64_t address = payload.get_address();
  const sc_core::sc_time begin = sc_core::sc_time_stamp() + delay;
  to_target->b_transport(payload, delay);
  ended(payload, address, begin, sc_core::sc_time_stamp() + delay);
}

tlm::tlm_sync_enum AccessProbe::nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                                sc_core::sc_time& delay) {
  if (phase == tlm::BEGIN_REQ) begun_[&payload] = {payload.get_address(), sc_core::sc_time_stamp() + delay};
  const tlm::tlm_sync_enum status = to_target->nb_transport_fw(payload, phase, delay);
  if (status == tlm::TLM_COMPLETED || (status == tlm::TLM_UPDATED && phase == tlm::BEGIN_RESP))
    end(payload, delay);
  return status;
}

tlm::tlm_sync_enum AccessProbe::nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                                sc_core::sc_time& delay) {
  if (phase == tlm::BEGIN_RESP) end(payload, delay);
  return from_initiator->nb_transport_bw(payload, phase, delay);
}

void AccessProbe::end(const tlm::tlm_generic_payload& payload, const sc_core::sc_time& delay) {
  const auto found = begun_.find(&payload);
  if (found == begun_.end()) return;  // TLM_COMPLETED for END_RESP
  const Begun begun = found->second;
  begun_.erase(found);
  ended(payload, begun.address, begun.begin, sc_core::sc_time_stamp() + delay);
}

void AccessProbe::ended(const tlm::tlm_generic_payload& payload, std::uint64_t address,
                        const sc_core::sc_time& begin, const sc_core::sc_time& end) {
  SeenAccess access{begin, end, payload.is_write(), address, {}, payload.get_response_status()};
  if (payload.get_command() != tlm::TLM_IGNORE_COMMAND) {
    access.words.resize(payload.get_data_length() / 4);
    std::memcpy(access.words.data(), payload.get_data_ptr(), 4 * access.words.size());
  }
  accesses_.push_back(std::move(access));
}

}  // namespace stereotlm::test
