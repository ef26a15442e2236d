#pragma once

#include <string>
#include <systemc>
#include <tlm>
#include <tuple>
#include <vector>

#include "models/testing/payload_rules.h"
#include "models/testing/phase_tracker.h"

namespace stereotlm::test {

// Forwards every call between an initiator and a target unchanged, and checks that both keep the base
// protocol (IEEE Std 1666-2011, 11 and 14 to 16) and the rules of ProtocolOptions. A violation reads
// "<monitor> at <time>: <call>: <value found and the rule>". Those that nobody has taken out are failures
// (failure.h) when the monitor is destroyed. So is each access that is open then: one without return from
// b_transport, or without END_RESP.
class ProtocolMonitor : public sc_core::sc_module,
                        public tlm::tlm_fw_transport_if<>,
                        public tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_target_socket<32> from_initiator{"from_initiator"};  // from the initiator of the link
  tlm::tlm_initiator_socket<32> to_target{"to_target"};         // to the target of the link

  // Both sockets must be bound. `options`: the rules of this link.
  explicit ProtocolMonitor(const sc_core::sc_module_name& name, const ProtocolOptions& options = {});
  ~ProtocolMonitor() override;

  // Returns and removes the violations, of which the first hundred are kept.
  std::vector<std::string> take_violations();
  // Fails with the violations and the open accesses of all monitors that exist, as if they were destroyed.
  // gtest_main.cpp calls it at the end of each test.
  static void fail_at_end();

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) override;
  unsigned int transport_dbg(tlm::tlm_generic_payload& payload) override;
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) override;

 private:
  using Process = const sc_core::sc_process_b*;
  // Payload, process, address as requested, time of the request.
  using Blocking = std::tuple<const tlm::tlm_generic_payload*, Process, sc_dt::uint64, sc_core::sc_time>;

  void fail_all();
  bool in_b_transport(const tlm::tlm_generic_payload& payload) const;
  void check_non_blocking(const char* call, const tlm::tlm_generic_payload& payload);
  void report(const char* call, const Problems& problems);
  void report(const char* call, const std::string& problem);

  ProtocolOptions options_;
  PhaseTracker phases_;
  // The calls in progress.
  std::vector<Blocking> blocking_;
  std::vector<Process> forward_;
  std::vector<Process> backward_;
  std::vector<std::string> violations_;
};

}  // namespace stereotlm::test
