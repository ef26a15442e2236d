#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/clock.h"
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
// clocked process calls arbitrate() once per cycle. There are two ways to make an access, both one word and
// base protocol:
//
// - A stage of the owner's clock domain is routed to its bank for a frame, and its requests come as the
// argument of
//   arbitrate(); if one is granted, the stage makes the access in the same cycle by b_transport, which takes
//   no simulated time and adds the bank's read time to `delay`. b_transport without a grant, or of another
//   bank or direction than the port's route, is answered TLM_GENERIC_ERROR_RESPONSE and does not reach the
//   bank.
// - Anybody else sends BEGIN_REQ by nb_transport_fw. The request takes part in arbitration from the first
//   cycle that begins at or after the request's time, until BEGIN_RESP says that it has been granted. Its time
//   is when it is done: for a read the beginning of the cycle in which the word is usable, for a write, or a
//   request that the bank refuses, the end of the cycle of the grant. One transaction per port at a time: the
//   next BEGIN_REQ comes after END_RESP (or TLM_COMPLETED).
//
// An address of a bank that does not exist is answered TLM_ADDRESS_ERROR_RESPONSE at once; other errors are the bank's.
// Debug transport and DMI reach every bank without a grant.
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
  // One cycle, which begins at `edge_ps`: decides the requests of the stages together with those that wait in
  // the sockets, carries out the latter's accesses, and returns the ports granted.
  PortMask arbitrate(std::uint64_t cycle, std::uint64_t edge_ps, PortMask requests) {
    granted_ = static_cast<PortMask>(requests & alone_);
    ++alone_cycles_[granted_];
    const auto others = static_cast<PortMask>(requests & ~alone_);
    if (pending_ == 0 && others == 0) {
      socket_requests_ = 0;
      return granted_;
    }
    return arbitrate_shared(cycle, edge_ps, others);
  }
  // Ports whose nb_transport request took part in the last arbitrate().
  PortMask socket_requests() const { return socket_requests_; }
  // Whether an nb_transport request waits for a cycle; `request_event` is notified when one arrives.
  bool request_pending() const { return pending_ != 0; }
  // The time of the earliest of them; one must wait.
  std::uint64_t earliest_request_ps() const;
  const sc_core::sc_event& request_event() const { return request_event_; }

  // Only cycles first_cycle .. end_cycle - 1 are counted in the arbiters' statistics, which are complete when
  // counting has ended.
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);
  const std::vector<BankArbiter>& arbiters() const { return arbiters_; }

 private:
  struct Waiting {
    tlm::tlm_generic_payload* access = nullptr;
    std::uint64_t from_ps = 0;
    bool responding = false;  // BEGIN_RESP sent, END_RESP to come
  };

  // The target behind one port's socket, and where its requests go.
  class PortTarget : public tlm::tlm_fw_transport_if<> {
   public:
    PortTarget(Crossbar& crossbar, std::size_t port)
        : crossbar_(crossbar), port_(port), port_mask_(mask_of(static_cast<Port>(port))) {}
    void route(std::size_t bank, bool write, tlm::tlm_blocking_transport_if<>& target);
    std::size_t bank() const { return bank_; }
    bool writes() const { return write_; }
    void access_bank(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) const;
    void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
    tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                       sc_core::sc_time& delay) override {
      return crossbar_.forward(port_, access, phase, delay);
    }
    unsigned transport_dbg(tlm::tlm_generic_payload& access) override { return crossbar_.debug(access); }
    bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override {
      return crossbar_.grant_dmi(access, dmi);
    }

   private:
    Crossbar& crossbar_;
    std::size_t port_;
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
  tlm::tlm_sync_enum forward(std::size_t port, tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                             sc_core::sc_time& delay);
  unsigned debug(tlm::tlm_generic_payload& access);
  bool grant_dmi(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi);
  void invalidate_dmi(int bank, sc_dt::uint64 start, sc_dt::uint64 end);
  bool has_bank(std::uint64_t address) const { return bank_of_address(address) < arbiters_.size(); }
  void settle();
  PortMask arbitrate_shared(std::uint64_t cycle, std::uint64_t edge_ps, PortMask requests);
  PortMask ready_socket_requests(std::uint64_t edge_ps) const;
  void respond(std::size_t port, std::uint64_t cycle);

  Clock clock_;
  std::vector<BankArbiter> arbiters_;
  std::vector<int> read_latencies_;  // cycles, of each bank
  std::deque<PortTarget> targets_;
  PortMask routed_ = 0;
  PortMask writes_ = 0;  // ports whose route writes
  // Stages alone on a bank without turnaround need no arbitration: the arbiter hears of their grants later.
  PortMask alone_ = 0;
  std::array<std::uint64_t, std::size_t{1} << kPortCount> alone_cycles_{};  // [ports granted in this way]
  std::array<SharedBank, kPortCount> shared_banks_{};
  std::size_t shared_bank_count_ = 0;
  PortMask granted_ = 0;  // to stages, in the current cycle, and not yet used
  std::array<Waiting, kPortCount> waiting_{};
  PortMask sockets_ = 0;  // ports that send requests by nb_transport
  PortMask pending_ = 0;  // of these, with a waiting request
  PortMask socket_requests_ = 0;
  sc_core::sc_event request_event_;
};

}  // namespace stereotlm::memory
