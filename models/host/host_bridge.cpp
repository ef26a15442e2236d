#include "models/host/host_bridge.h"

#include <cstddef>
#include <cstring>

#include "models/access_rules.h"

namespace stereotlm::host {

HostBridge::HostBridge(const sc_core::sc_module_name& name) : sc_module(name) {
  cpu.register_b_transport(this, &HostBridge::transport);
}

void HostBridge::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, {});
  if (status == tlm::TLM_OK_RESPONSE) {
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    delay = sc_core::SC_ZERO_TIME;
    const std::uint64_t turn = arrived_++;
    while (turn != served_) wait(next_turn_);
    status = transfer(access);
    ++served_;
    next_turn_.notify(sc_core::SC_ZERO_TIME);
  }
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE)
    refusals_.report(access, AccessRules{}, "no target of the PCI bus takes it");
}

tlm::tlm_response_status HostBridge::transfer(tlm::tlm_generic_payload& access) {
  const std::size_t length = access.get_data_length();
  for (std::size_t done = 0; done < length;) {
    unsigned char* data = access.get_data_ptr() + done;
    words_.resize((length - done) / 4);
    if (access.is_write()) std::memcpy(words_.data(), data, length - done);
    burst_ = {access.is_write(), access.get_address() + done, &words_};
    pci->request(*this);
    wait(ended_);
    if (result_.end == pci::BurstEnd::kMasterAbort) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (result_.end == pci::BurstEnd::kTargetError) return tlm::TLM_GENERIC_ERROR_RESPONSE;
    if (access.is_read()) std::memcpy(data, words_.data(), result_.words * 4);
    done += result_.words * 4;
  }
  return tlm::TLM_OK_RESPONSE;
}

pci::PciBurst HostBridge::begin_burst(std::uint64_t /*address_clock_ps*/) { return burst_; }

void HostBridge::end_burst(const pci::BurstResult& result) {
  result_ = result;
  ended_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace stereotlm::host
