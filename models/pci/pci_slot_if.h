#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <systemc>
#include <tlm>
#include <utility>

#include "models/access_rules.h"
#include "models/kernel_time.h"
#include "models/pci/pci_slot.h"
#include "models/refusals.h"

// The sockets between the PCI bus and its masters and targets.
namespace stereotlm::pci {

// A slot of the bus for the port of a master.
class PciSlotIf : public virtual sc_core::sc_interface, public PciSlot {
 public:
  using PciSlot::request;
  // Requests the bus from now on.
  void request(PciMasterIf& master) { request(master, kernel_time::now_ps()); }
};

// Sockets of the slot: `capture.pci.bind(bus.slots[0])`. The port is also the slot of a module's control: it
// passes the calls of the control to the bus, and those of the bus to the control. A std::logic_error or
// std::runtime_error of the control goes to `report`. `then` is called after the end of a burst.
class PciMasterPort : public sc_core::sc_port<PciSlotIf>, public PciSlot, private PciMasterIf {
 public:
  // `report` must be given for a control that throws.
  explicit PciMasterPort(const char* name, std::function<void()> then = {},
                         std::function<void(const std::exception&)> report = {})
      : sc_port(name), then_(std::move(then)), report_(std::move(report)) {}

  void request(PciMasterIf& control, std::uint64_t from_ps) override {
    control_ = &control;
    (*this)->request(*this, from_ps);
  }
  BurstResult transferred(std::uint64_t now_ps) const override { return (*this)->transferred(now_ps); }
  const Clock& clock() const override { return (*this)->clock(); }

 private:
  PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    PciBurst burst;
    guard([&] { burst = control_->begin_burst(address_clock_ps); });
    return burst;
  }
  void end_burst(const BurstResult& result) override {
    guard([&] { control_->end_burst(result); });
    if (then_) then_();
  }
  template <class Call>
  void guard(const Call& call) const try {
    call();
  } catch (const std::logic_error& error) {
    report_(error);
  } catch (const std::runtime_error& error) {
    report_(error);
  }

  std::function<void()> then_;
  std::function<void(const std::exception&)> report_;
  PciMasterIf* control_ = nullptr;
};
using PciSlotExport = sc_core::sc_export<PciSlotIf>;  // of a slot

// STOP#, which the base protocol has no phase for. A target without it takes bursts of any length.
class PciStopIf : public virtual sc_core::sc_interface {
 public:
  // Called at the address clock of a write. Returns how many of its `words` words the target takes, 0..words.
  virtual std::size_t writable_words(std::uint64_t address, std::size_t words) const = 0;
};

// Makes the access of a transaction to the registers of a control, which lie below `end`. Responses: those of
// check_access(), and TLM_COMMAND_ERROR_RESPONSE if the register does not have this direction.
inline void access_registers(PciTarget& registers, std::uint64_t end, tlm::tlm_generic_payload& access,
                             const sc_core::sc_time& delay, Refusals& refusals) {
  tlm::tlm_response_status status = check_access(access, registers_below(end));
  const bool is_one_word = status == tlm::TLM_OK_RESPONSE;
  std::uint32_t word = 0;
  if (is_one_word && access.is_write()) std::memcpy(&word, access.get_data_ptr(), 4);
  const std::uint64_t now_ps = kernel_time::now_ps();
  // The control counts what it refuses, an access of no word too.
  const bool ok = registers
                      .access(now_ps, {access.is_write(), access.get_address(), &word, is_one_word ? 1U : 0U},
                              now_ps + kernel_time::to_ps(delay))
                      .ok;
  if (ok && access.is_read()) std::memcpy(access.get_data_ptr(), &word, 4);
  if (is_one_word && !ok) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  refusals.respond(access, status, registers_below(end), "the register does not have this direction");
}

}  // namespace stereotlm::pci
