#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/memory/arbitration.h"
#include "models/memory/direct_banks.h"
#include "models/memory/memory_config.h"
#include "models/refusals.h"

namespace stereotlm::memory {

// The configuration of a Crossbar or a GenericCrossbar.
struct CrossbarConfig {
  ArbiterConfig arbiter;               // of each bank
  std::vector<SsramBankConfig> banks;  // [bank]; all banks have the same clock
};

// Every broken rule as `field = value: rule`; empty if the crossbar can be built.
std::vector<std::string> problems(const CrossbarConfig& config);

// The crossbar between the ports and the banks, with one arbiter per bank. It has no process: the clocked
// process of its owner calls arbitrate() once per cycle, with the ports that request. Each port is routed to
// one bank and one direction. The stage behind a granted port makes its access in the same cycle: one word by
// b_transport, which takes no simulated time and adds the bank's read time to `delay`.
//
// A route to a bank or of a port that does not exist is reported with SC_REPORT_ERROR (type
// /stereotlm/crossbar), and changes nothing.
//
// TLM_GENERIC_ERROR_RESPONSE refuses an access without a grant, an access of another bank or direction than
// the port's route, and every nb_transport. TLM_ADDRESS_ERROR_RESPONSE refuses an address of a bank that does
// not exist. Refused accesses reach no bank; other errors are responses of the bank. Debug transport reaches
// every bank without a grant. There is no DMI through the ports.
class Crossbar : public sc_core::sc_module, public DirectBanks {
 public:
  sc_core::sc_vector<tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 1,
                                            sc_core::SC_ZERO_OR_MORE_BOUND>>
      ports;  // [port]; an unused port may stay unbound
  sc_core::sc_vector<tlm_utils::simple_initiator_socket<Crossbar>> banks;  // [bank]

  // Throws std::invalid_argument if the configuration has problems.
  Crossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config);

  // Directs the accesses of the port to this bank. The port takes part in arbitrate() only where
  // Arbitration::route() has routed it.
  void aim(Port port, std::size_t bank, bool write);
  std::size_t bank_of(Port port) const { return arbitration_.bank_of(port); }  // bank of its last route
  // Decides the requests of one cycle, and returns the ports granted.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests) {
    return grant(arbitration_.arbitrate(cycle, requests));
  }
  // Grants these ports one access each in the current cycle. For an owner that calls arbitration() itself.
  PortMask grant(PortMask granted) {
    for_each_port(granted & arbitration_.placed(),
                  [this](Port port) { aim(port, arbitration_.bank_of(port), arbitration_.writes(port)); });
    granted_ = {static_cast<std::uint64_t>(granted), static_cast<std::uint64_t>(granted >> 64U)};
    return granted;
  }
  Arbitration& arbitration() { return arbitration_; }              // routes, arbiters and statistics
  const Arbitration& arbitration() const { return arbitration_; }  // routes, arbiters and statistics

  unsigned char* direct(std::uint64_t address, std::uint64_t bytes) override;
  void allow_access(Port port) override { grant(mask_of(port)); }

 private:
  // The target behind the socket of one port.
  class PortTarget : public tlm::tlm_fw_transport_if<> {
   public:
    PortTarget(Crossbar& crossbar, Port port)
        : crossbar_(crossbar), granted_(crossbar.granted_[port / 64]), port_(std::uint64_t{1} << port % 64) {}
    void route(std::size_t bank, bool write, tlm::tlm_blocking_transport_if<>& target);
    void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
    tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase&,
                                       sc_core::sc_time&) override {
      crossbar_.refuse(access);
      return tlm::TLM_COMPLETED;
    }
    unsigned transport_dbg(tlm::tlm_generic_payload& access) override { return crossbar_.debug(access); }
    bool get_direct_mem_ptr(tlm::tlm_generic_payload& /*access*/, tlm::tlm_dmi& dmi) override {
      dmi.allow_read_write();  // is refused, for all addresses
      return false;
    }

   private:
    Crossbar& crossbar_;
    std::uint64_t& granted_;  // the half of the crossbar's grants that holds this port
    std::uint64_t port_;      // its bit there
    tlm::tlm_command command_ = tlm::TLM_READ_COMMAND;
    std::uint64_t bank_base_ = 0;  // first address of the bank to which the port is directed
    tlm::tlm_blocking_transport_if<>* bank_port_ = nullptr;  // looked up once, for speed
  };
  void refuse(tlm::tlm_generic_payload& access);
  unsigned debug(tlm::tlm_generic_payload& access);
  bool has_bank(std::uint64_t address) const { return bank_of_address(address) < banks.size(); }

  Arbitration arbitration_;
  std::deque<PortTarget> targets_;
  // Grants of the current cycle that are not yet used: ports 0..63, then the others. A stage changes one
  // word.
  std::array<std::uint64_t, 2> granted_{};
  Refusals refusals_{*this};
};

}  // namespace stereotlm::memory
