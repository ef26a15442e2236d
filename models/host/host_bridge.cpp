#include "models/host/host_bridge.h"

#include <cstring>
#include <utility>

#include "models/access_rules.h"

namespace stereotlm::host {

HostBridge::HostBridge(const sc_core::sc_module_name& name) : sc_module(name) {
  cpu.register_b_transport(this, &HostBridge::transport);
}

void HostBridge::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, {});
  if (status == tlm::TLM_OK_RESPONSE) {
    AccessQueue::Place place(queue_, access);
    place.await_time(delay);
    place.await_turn();
    status = transfer(access, place);
    place.end();
  }
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE)
    refusals_.report(access, AccessRules{}, "no target of the PCI bus takes it");
}

tlm::tlm_response_status HostBridge::transfer(tlm::tlm_generic_payload& access, AccessQueue::Place& place) {
  while (!is_ended_) wait(ended_);  // the burst of an access that is lost
  const unsigned length = access.get_data_length();
  for (done_bytes_ = 0; done_bytes_ < length;) {
    const unsigned first = done_bytes_;
    unsigned char* const data = access.get_data_ptr() + first;
    words_.resize((length - first) / 4);
    if (access.is_write()) std::memcpy(words_.data(), data, length - first);
    run_burst({access.is_write(), access.get_address() + first, &words_}, place);
    if (result_.end == pci::BurstEnd::kMasterAbort) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (result_.end == pci::BurstEnd::kTargetError) return tlm::TLM_GENERIC_ERROR_RESPONSE;
    if (access.is_read()) std::memcpy(data, words_.data(), done_bytes_ - first);
  }
  return tlm::TLM_OK_RESPONSE;
}

void HostBridge::run_burst(const pci::PciBurst& burst, AccessQueue::Place& place) {
  burst_ = burst;
  pci->request(*this);
  try {
    while (burst_.words != nullptr || !is_ended_) wait(ended_);
  } catch (...) {  // the process is killed or reset
    place.set_done(done_bytes_);
    burst_ = {};
    throw;
  }
}

pci::PciBurst HostBridge::begin_burst(std::uint64_t /*address_clock_ps*/) {
  is_ended_ = burst_.words == nullptr;
  return std::exchange(burst_, {});
}

void HostBridge::end_burst(const pci::BurstResult& result) {
  result_ = result;
  done_bytes_ += static_cast<unsigned>(result.words * 4);
  is_ended_ = true;
  ended_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace stereotlm::host
