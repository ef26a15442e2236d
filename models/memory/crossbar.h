#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/memory/bank_arbiter.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// A byte address on the crossbar: the bank above bit 28, and the byte in that bank.
inline constexpr unsigned kBankAddressBits = 28;
constexpr std::uint64_t crossbar_address(std::uint64_t bank, std::uint64_t word) {
  return bank << kBankAddressBits | word << 2U;
}
constexpr std::uint64_t bank_of_address(std::uint64_t address) { return address >> kBankAddressBits; }

struct CrossbarConfig {
  ArbiterConfig arbiter;
  std::vector<SsramBankConfig> banks;  // what the memory controllers know about them; all of one clock
};

// The crossbar between the six ports and the banks, with one arbiter per bank. It has no process: its owner's
// clocked process calls arbitrate() once per cycle. A port is routed to the bank that it works on; its requests come as the
// argument of arbitrate(), and if one is granted, the stage behind the port makes the access in the same cycle: one word by
// b_transport, which takes no simulated time and adds the bank's read time to `delay`. Without a grant, or of another
// bank or direction than the port's route, it is answered TLM_GENERIC_ERROR_RESPONSE and does not reach the bank, as is
// every nb_transport.
//
// An address of a bank that does not exist is answered TLM_ADDRESS_ERROR_RESPONSE; other errors are the bank's. Debug
// transport and DMI reach every bank without a grant.
class Crossbar : public sc_core::sc_module {
 public:
  sc_core::sc_vector<tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 1,
                                            sc_core::SC_ZERO_OR_MORE_BOUND>>
      ports;  // [index_of(Port)]; one that nobody uses may stay unbound
  sc_core::sc_vector<tlm_utils::simple_initiator_socket_tagged<Crossbar>> banks;  // [bank]

  // Throws std::invalid_argument if the configuration has problems.
  Crossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config);

  // Requests of this port go to this bank, in this direction, from the next arbitrate() on. The bank must
  // exist.
  void route(Port port, std::size_t bank, bool write);
  // The port has nothing to request any more.
  void unroute(Port port);
  std::size_t bank_of(Port port) const { return targets_[index_of(port)].bank(); }  // of its last route
  // One cycle: decides these requests, and returns the ports granted.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests) {
    granted_ = static_cast<PortMask>(requests & alone_);
    ++alone_cycles_[granted_];
    if (requests != granted_) arbitrate_shared(cycle, static_cast<PortMask>(requests & ~alone_));
    return granted_;
  }

  // Only cycles first_cycle .. end_cycle - 1 are counted in the arbiters' statistics, which are complete when
  // counting has ended; their uncounted_accesses() always.
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);
  const std::vector<BankArbiter>& arbiters() const {
    settle();
    return arbiters_;
  }

 private:
  // The target behind one port's socket, and where its requests go.
  class PortTarget : public tlm::tlm_fw_transport_if<> {
   public:
    PortTarget(Crossbar& crossbar, Port port) : crossbar_(crossbar), port_mask_(mask_of(port)) {}
    void route(std::size_t bank, bool write, tlm::tlm_blocking_transport_if<>& target);
    std::size_t bank() const { return bank_; }
    bool writes() const { return write_; }
    void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
    tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase&,
                                       sc_core::sc_time&) override {
      crossbar_.refuse(access);
      return tlm::TLM_COMPLETED;
    }
    unsigned transport_dbg(tlm::tlm_generic_payload& access) override { return crossbar_.debug(access); }
    bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override {
      return crossbar_.grant_dmi(access, dmi);
    }

   private:
    Crossbar& crossbar_;
    PortMask port_mask_;
    bool write_ = false;
    std::size_t bank_ = 0;
    std::uint64_t bank_base_ = 0;                            // its first address
    tlm::tlm_blocking_transport_if<>* bank_port_ = nullptr;  // found once, for speed
  };
  // A bank whose ports meet, or which needs turnaround.
  struct SharedBank {
    BankArbiter* arbiter = nullptr;
    PortMask ports = 0;
  };

  void refuse(tlm::tlm_generic_payload& access) const;
  unsigned debug(tlm::tlm_generic_payload& access);
  bool grant_dmi(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi);
  void invalidate_dmi(int bank, sc_dt::uint64 start, sc_dt::uint64 end);
  bool has_bank(std::uint64_t address) const { return bank_of_address(address) < arbiters_.size(); }
  void share_banks();
  void settle() const;
  void arbitrate_shared(std::uint64_t cycle, PortMask requests);

  mutable std::vector<BankArbiter> arbiters_;
  std::deque<PortTarget> targets_;
  PortMask routed_ = 0;
  PortMask writes_ = 0;  // ports whose route writes
  // Ports alone on a bank without turnaround need no arbitration: the arbiter hears of their grants later, at
  // the latest when somebody asks it.
  PortMask alone_ = 0;
  mutable std::array<std::uint64_t, std::size_t{1} << kPortCount>
      alone_cycles_{};  // [ports granted in this way]
  std::array<SharedBank, kPortCount> shared_banks_{};
  std::size_t shared_bank_count_ = 0;
  PortMask granted_ = 0;  // in the current cycle, and not yet used
};

}  // namespace stereotlm::memory
