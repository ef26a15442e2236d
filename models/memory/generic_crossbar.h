#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "models/access_queue.h"
#include "models/clock.h"
#include "models/decision_point.h"
#include "models/memory/bank_arbiter.h"
#include "models/memory/crossbar.h"
#include "models/refusals.h"
#include "models/step_event.h"

namespace stereotlm::memory {

// A crossbar between any initiators of the TLM-2.0 base protocol and the banks, with the arbiters of Crossbar
// (contract section 2). An initiator knows nothing of requests and grants: its access takes the time that the
// arbiters give it.
//
// An access has any number of words in one bank, at the addresses of crossbar_address(). Its first word
// requests from the first cycle on that begins at or after the time of the access. Each further word requests
// from the cycle after the grant of the word before. The arbiters decide about a cycle after everything else
// that happens at its beginning. A word that is granted accesses the bank in its cycle, by b_transport; a
// bank must not wait there. With a bank of separate ports the read of a cycle comes before its write.
//
// b_transport waits for the grant of the last word. It returns in the cycle of this grant, with the rest of
// the access as `delay`: of a read up to the time at which its last word is usable, of a write up to the end
// of the cycle. A port serves one access at a time, in the order in which they arrive. nb_transport is
// turned into b_transport: no END_REQ is sent, because BEGIN_RESP implies it. Debug transport reaches every
// bank at once. There is no DMI.
//
// A process may be killed or reset while it waits in b_transport. Its access is lost, and reported
// (AccessQueue): the words that have been granted access the bank, the others are dropped. The port serves
// the next access at once.
//
// | access                                                         | response                       |
// |----------------------------------------------------------------|--------------------------------|
// | one that breaks a rule of check_access(); byte enables are     | that of check_access()         |
// | allowed                                                        |                                |
// | an address in no bank, or words in two banks                   | TLM_ADDRESS_ERROR_RESPONSE     |
// | a word that its bank refuses: the words behind it are left out | that of the bank               |
//
// The first access of each port that the crossbar refuses is reported (refusals.h).
class GenericCrossbar : public sc_core::sc_module {
 public:
  sc_core::sc_vector<tlm_utils::simple_target_socket_tagged<GenericCrossbar>> ports;  // [port]
  sc_core::sc_vector<tlm_utils::simple_initiator_socket<GenericCrossbar>> banks;      // [bank]

  // Throws std::invalid_argument if the configuration has problems.
  GenericCrossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config);

  const Clock& clock() const { return clock_; }  // of all banks
  // The counters of a bank, of all cycles before the present time, and of the present one if it is decided.
  ArbiterStats stats(std::size_t bank) const;

 private:
  // The access that a port serves.
  struct PortState {
    explicit PortState(const sc_core::sc_object& socket) : queue(socket), refusals(socket) {}

    AccessQueue queue;
    tlm::tlm_generic_payload* access = nullptr;
    unsigned done_bytes = 0;
    std::uint64_t from_cycle = 0;  // its next word requests from this cycle on
    sc_core::sc_time delay;        // of the rest, after its last grant
    sc_core::sc_event ended;
    Refusals refusals;
  };

  void transport(int port, tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  unsigned debug(int port, tlm::tlm_generic_payload& access);
  tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) const;
  void begin_cycle();
  void decide();
  void decide(std::size_t bank, std::uint64_t cycle, PortMask requests, PortMask writes);
  void access_banks();
  void access_granted_words();
  void access_word(PortState& port, std::size_t bank);
  void await_cycle();

  Clock clock_;
  std::vector<BankArbiter> arbiters_;                 // [bank]
  std::deque<PortState> states_;                      // [port]
  std::uint64_t first_undecided_ = 0;                 // cycle
  std::array<std::uint32_t, kMostPorts> words_{};     // [port]: the word that it requests
  std::deque<std::pair<Port, std::size_t>> granted_;  // port and bank, in the order of their accesses
  sc_core::sc_event accesses_{"accesses"};
  StepEvent cycle_{"cycle"};
  DecisionPoint decision_{"decision", [this] { decide(); }};
};

}  // namespace stereotlm::memory
