#include "models/pci/pci_bridge.h"

#include <cstring>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {

PciBridge::PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config)
    : sc_module(name), control_(checked(this->name(), config), pci, *this, *this) {
  SC_HAS_PROCESS(PciBridge);
  kernel_time::check_resolution(*this);
  slave.register_b_transport(this, &PciBridge::access_slave);
  registers.register_b_transport(this, &PciBridge::access_registers);
  local.register_nb_transport_bw(this, &PciBridge::respond);
  stop.bind(*this);
  interrupt.bind(*this);
  SC_METHOD(ring);
  sensitive << doorbell.pos();
  dont_initialize();
  SC_METHOD(step);
  sensitive << step_;
  dont_initialize();
}

void PciBridge::step() {
  step_.taken();
  control_.step(kernel_time::now_ps());
  await_step();
}

std::size_t PciBridge::writable_words(std::uint64_t address, std::size_t words) const {
  return control_.postable_words(kernel_time::now_ps(), address, words);
}

void PciBridge::access_slave(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, {bridge::kSlaveWindowBytes});
  if (status != tlm::TLM_OK_RESPONSE) {
    control_.count_error();
  } else {
    AccessQueue& queue = access.is_read() ? slave_reads_ : slave_writes_;
    const auto serve = [&] { status = access.is_read() ? read_slave(access) : write_slave(access); };
    queue.serve(access, delay, serve, [] { return 0U; });
  }
  refusals_.respond(access, status, {bridge::kSlaveWindowBytes},
                    access.is_read() ? "the local bus has refused a word" : "more words than can be posted");
}

tlm::tlm_response_status PciBridge::write_slave(const tlm::tlm_generic_payload& access) {
  const bool ok = control_.write(kernel_time::now_ps(), access.get_address(), access.get_data_ptr(),
                                 access.get_data_length() / 4);
  await_step();
  return ok ? tlm::TLM_OK_RESPONSE : tlm::TLM_BURST_ERROR_RESPONSE;
}

// Waits until the words have arrived.
tlm::tlm_response_status PciBridge::read_slave(const tlm::tlm_generic_payload& access) {
  while (reads_) wait(read_ended_);  // the read of an access that is lost
  reads_ = true;
  read_bytes_.resize(access.get_data_length());
  control_.read(kernel_time::now_ps(), access.get_address(), read_bytes_.data(), read_bytes_.size() / 4);
  await_step();
  while (reads_) wait(read_ended_);
  if (!read_ok_) return tlm::TLM_GENERIC_ERROR_RESPONSE;
  std::memcpy(access.get_data_ptr(), read_bytes_.data(), read_bytes_.size());
  return tlm::TLM_OK_RESPONSE;
}

void PciBridge::slave_read_ended(std::uint64_t /*now_ps*/, bool ok) {
  reads_ = false;
  read_ok_ = ok;
  read_ended_.notify(sc_core::SC_ZERO_TIME);
}

void PciBridge::access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  pci::access_registers(control_, bridge::kRegisterWindowBytes, access, delay, refusals_);
  await_step();
}

void PciBridge::ring() {
  control_.ring(kernel_time::now_ps());
  await_step();
}

bool PciBridge::begin_burst(std::uint64_t /*now_ps*/, const LocalBurst& burst) {
  const auto bytes = static_cast<unsigned>(burst.words * 4);
  burst_.set_command(burst.write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  burst_.set_address(burst.address);
  burst_.set_data_ptr(burst.data);
  burst_.set_data_length(bytes);
  burst_.set_streaming_width(bytes);
  burst_.set_byte_enable_ptr(nullptr);
  burst_.set_dmi_allowed(false);
  burst_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time delay;
  burst_.acquire();
  if (local->nb_transport_fw(burst_, phase, delay) == tlm::TLM_COMPLETED) end_local_burst(delay);
  return true;
}

tlm::tlm_sync_enum PciBridge::respond(tlm::tlm_generic_payload& /*burst*/, tlm::tlm_phase& phase,
                                      sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  end_local_burst(delay);
  await_step();
  return tlm::TLM_COMPLETED;
}

void PciBridge::end_local_burst(const sc_core::sc_time& delay) {
  const bool ok = burst_.is_response_ok();
  burst_.release();
  control_.local_bus_master().end_burst_at(kernel_time::now_ps() + kernel_time::to_ps(delay), ok);
}

}  // namespace stereotlm::pci
