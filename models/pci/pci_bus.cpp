#include "models/pci/pci_bus.h"

#include <stdexcept>
#include <utility>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {
namespace {

constexpr char kPciBusReport[] = "/stereotlm/pci_bus";

}  // namespace

PciBus::PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config)
    : sc_module(name),
      slots("slot", config.masters.size()),
      targets("target", config.windows.size()),
      stops("stop", config.windows.size()),
      control_(checked(this->name(), config)) {
  kernel_time::check_resolution(*this);
  SC_HAS_PROCESS(PciBus);
  for (std::size_t master = 0; master < slots.size(); ++master)
    slots[master].bind(slots_.emplace_back(*this, master));
  for (std::size_t window = 0; window < targets.size(); ++window)
    control_.bind(window, targets_.emplace_back(*this, window));
  SC_METHOD(step);
  sensitive << step_;
  dont_initialize();
  SC_THREAD(run_transports);
}

std::size_t PciBus::Target::writable_words(std::uint64_t /*now_ps*/, std::uint64_t address,
                                           std::size_t words) {
  const PciStopPort& stop = bus_.stops[window_];
  if (stop.size() == 0) return words;
  const std::size_t taken = stop->writable_words(address, words);
  if (taken <= words) return taken;
  SC_REPORT_ERROR(kPciBusReport, (std::string(stop.name()) + ": " + std::to_string(taken) + " of " +
                                  std::to_string(words) + " words can be written")
                                     .c_str());
  return words;
}

void PciBus::await_step() {
  if (decides_) return;
  const bool in_thread = control_.writes_next();
  step_.set(in_thread ? kNever : control_.next_ps());
  transport_.set(in_thread ? control_.next_ps() : kNever);
}

void PciBus::step() {
  step_.taken();
  if (control_.decides_next()) {
    decides_ = true;
    decision_.request();
  } else {
    control_.step(kernel_time::now_ps());
    await_step();
  }
}

void PciBus::decide() {
  decides_ = false;
  try {
    control_.decide(kernel_time::now_ps());
  } catch (const std::logic_error& error) {
    SC_REPORT_ERROR(kPciBusReport, error.what());
  }
  await_step();
}

// b_transport may wait, and is therefore called in a thread. A write that ends in this thread costs no
// further event.
void PciBus::run_transports() {
  for (;;) {
    wait(transport_);
    if (std::exchange(access_is_due_, false)) {
      const PciAnswer answer = transport();
      control_.answer(kernel_time::now_ps(), answer);
    } else {
      transport_.taken();
      in_thread_ = true;
      control_.step(kernel_time::now_ps());
      in_thread_ = false;
    }
    await_step();
  }
}

PciAnswer PciBus::access(std::size_t window, const PciAccess& access, std::uint64_t at_ps) {
  access_.set_command(access.write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  access_.set_address(access.address);
  access_.set_data_ptr(reinterpret_cast<unsigned char*>(access.words));
  access_.set_data_length(static_cast<unsigned>(access.count * sizeof(std::uint32_t)));
  window_ = window;
  access_ps_ = at_ps;
  if (in_thread_) return transport();
  access_is_due_ = true;
  transport_.notify();
  return {kNever, true};
}

PciAnswer PciBus::transport() {
  access_.set_streaming_width(access_.get_data_length());
  access_.set_byte_enable_ptr(nullptr);
  access_.set_byte_enable_length(0);
  access_.set_dmi_allowed(false);
  access_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = kernel_time::to_time(access_ps_ - kernel_time::now_ps());
  targets[window_]->b_transport(access_, delay);
  return {kernel_time::now_ps() + kernel_time::to_ps(delay), access_.is_response_ok()};
}

}  // namespace stereotlm::pci
