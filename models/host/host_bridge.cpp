#include "models/host/host_bridge.h"

#include <cstring>

#include "models/access_rules.h"

namespace stereotlm::host {

HostBridge::HostBridge(const sc_core::sc_module_name& name) : sc_module(name) {
  cpu.register_b_transport(this, &HostBridge::transport);
}

void HostBridge::transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, {});
  if (status == tlm::TLM_OK_RESPONSE) {
    const auto serve = [&] { status = transfer(access); };
    const auto drop = [this] {
      if (state_ == State::kRequested) state_ = State::kIdle;
      if (state_ == State::kGranted) state_ = State::kLost;
      return done_bytes_;
    };
    queue_.serve(access, delay, serve, drop);
  }
  refusals_.respond(access, status, {}, "no target of the PCI bus takes it");
}

tlm::tlm_response_status HostBridge::transfer(tlm::tlm_generic_payload& access) {
  const unsigned length = access.get_data_length();
  done_bytes_ = 0;
  while (state_ != State::kIdle) wait(ended_);  // the burst of an access that is lost
  while (done_bytes_ < length) {
    const unsigned first = done_bytes_;
    unsigned char* const data = access.get_data_ptr() + first;
    words_.resize((length - first) / 4);
    if (access.is_write()) std::memcpy(words_.data(), data, length - first);
    burst_ = {access.is_write(), access.get_address() + first, &words_};
    state_ = State::kRequested;
    pci->request(*this);
    while (state_ != State::kIdle) wait(ended_);
    if (end_ == pci::BurstEnd::kMasterAbort) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (end_ == pci::BurstEnd::kTargetError) return tlm::TLM_GENERIC_ERROR_RESPONSE;
    if (access.is_read()) std::memcpy(data, words_.data(), done_bytes_ - first);
  }
  return tlm::TLM_OK_RESPONSE;
}

pci::PciBurst HostBridge::begin_burst(std::uint64_t /*address_clock_ps*/) {
  if (state_ != State::kRequested) return {};
  state_ = State::kGranted;
  return burst_;
}

void HostBridge::end_burst(const pci::BurstResult& result) {
  end_ = result.end;
  if (state_ == State::kGranted) done_bytes_ += static_cast<unsigned>(result.words * 4);
  state_ = State::kIdle;
  ended_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace stereotlm::host
