#include "models/fpga/local_bus.h"

#include <algorithm>
#include <string>

#include "models/access_rules.h"

namespace stereotlm::fpga {
namespace {

LocalBurst burst_of(const tlm::tlm_generic_payload& access) {
  return {access.is_write(), access.get_address(), access.get_data_ptr(), access.get_data_length() / 4};
}

}  // namespace

LocalBus::LocalBus(const sc_core::sc_module_name& name, const LocalBusConfig& config, std::size_t banks)
    : sc_module(name), control_(config, banks, *this) {
  SC_HAS_PROCESS(LocalBus);
  kernel_time::check_resolution(*this);
  control_.bind(*this);
  bus.bind(*this);
  SC_THREAD(run_registers);
}

tlm::tlm_response_status LocalBus::check(const tlm::tlm_generic_payload& access) const {
  const tlm::tlm_response_status status = check_access(access, {});
  if (status != tlm::TLM_OK_RESPONSE) return status;
  if (!access.has_mm()) return tlm::TLM_GENERIC_ERROR_RESPONSE;  // the bus keeps a reference
  switch (control_.refusal_of(burst_of(access))) {
    case LocalBusControl::Refusal::kAddress:
      return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    case LocalBusControl::Refusal::kLength:
      return tlm::TLM_BURST_ERROR_RESPONSE;
    case LocalBusControl::Refusal::kNone:
      break;
  }
  return status;
}

void LocalBus::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time&) {
  control_.count_error();
  access.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
  refusals_.report(access, "must come by nb_transport");
}

tlm::tlm_sync_enum LocalBus::nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase == tlm::END_RESP && responding_) {
    responding_ = false;
    burst_ = nullptr;
    return tlm::TLM_COMPLETED;
  }
  if (phase != tlm::BEGIN_REQ || burst_ != nullptr) {
    SC_REPORT_ERROR("/stereotlm/local_bus", (std::string(name()) + ": phase out of order").c_str());
    return tlm::TLM_ACCEPTED;
  }
  if (!refusals_.respond(access, check(access), {},
                         access.has_mm() ? "all words must be in one bank, or in the registers"
                                         : "must have a memory manager (set_mm())")) {
    control_.count_error();
    return tlm::TLM_COMPLETED;
  }
  {
    const struct Beginning {  // also if a bank throws
      explicit Beginning(bool& its) : is(its) { is = true; }
      ~Beginning() { is = false; }
      bool& is;
    } beginning(is_beginning_);
    begin(access, delay);
  }
  if (burst_ != nullptr) return tlm::TLM_ACCEPTED;
  delay = end_delay_;
  return tlm::TLM_COMPLETED;
}

void LocalBus::begin(tlm::tlm_generic_payload& access, const sc_core::sc_time& delay) {
  access.acquire();
  burst_ = &access;
  status_ = tlm::TLM_OK_RESPONSE;
  const std::uint64_t now_ps = kernel_time::now_ps();
  control_.begin(now_ps + kernel_time::to_ps(delay), burst_of(access));
  // The receiver of the route may have granted all words.
  if (control_.word_waits()) request_event_.notify(kernel_time::to_time(control_.request_ps() - now_ps));
  await_register();
}

void LocalBus::await_register() {
  if (control_.next_ps() == kNever) return;
  register_event_.notify(kernel_time::to_time(control_.next_ps() - kernel_time::now_ps()));
}

void LocalBus::run_registers() {
  for (;;) {
    wait(register_event_);
    control_.step(kernel_time::now_ps());
    await_register();
  }
}

bool LocalBus::access_bank(std::uint64_t at_ps, bool write, std::uint64_t address, std::uint32_t& word) {
  const std::uint64_t now_ps = kernel_time::now_ps();
  return transfer(memory_access_, write, address, word,
                  kernel_time::to_time(std::max(at_ps, now_ps) - now_ps));
}

bool LocalBus::access_register(std::uint64_t /*now_ps*/, bool write, std::uint64_t address,
                               std::uint32_t& word) {
  return transfer(register_access_, write, address, word, sc_core::SC_ZERO_TIME);
}

bool LocalBus::transfer(memory::WordAccess& through, bool write, std::uint64_t address, std::uint32_t& word,
                        sc_core::sc_time delay) {
  const bool ok = write ? through.write(address, word, delay) : through.read(address, delay);
  if (!write) word = through.word();
  if (!ok && status_ == tlm::TLM_OK_RESPONSE) status_ = through.status();
  return ok;
}

void LocalBus::end_burst_at(std::uint64_t end_ps, bool /*ok*/) {
  tlm::tlm_generic_payload& access = *burst_;
  access.set_response_status(status_);
  sc_core::sc_time delay = kernel_time::to_time(end_ps) - sc_core::sc_time_stamp();
  if (is_beginning_) {  // nb_transport_bw may not be called within nb_transport_fw
    end_delay_ = delay;
    burst_ = nullptr;
  } else {
    responding_ = true;
    tlm::tlm_phase phase = tlm::BEGIN_RESP;
    const tlm::tlm_sync_enum answer = bus->nb_transport_bw(access, phase, delay);
    if (answer == tlm::TLM_COMPLETED || (answer == tlm::TLM_UPDATED && phase == tlm::END_RESP)) {
      responding_ = false;
      burst_ = nullptr;
    }
  }
  access.release();
}

unsigned LocalBus::transport_dbg(tlm::tlm_generic_payload& access) {
  return access.get_address() < kLocalRegisters ? memory->transport_dbg(access) : 0;
}

}  // namespace stereotlm::fpga
