#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "models/kernel_time.h"

namespace stereotlm::test {

// A transaction that was seen on a link.
struct LoggedTransaction {
  std::string link;
  std::uint64_t time_ps = 0;  // at which it begins
  bool write = false;
  std::uint64_t address = 0;
};

// Forwards the calls of an initiator unchanged, and logs its blocking transactions.
class TransactionLogger : public sc_core::sc_module,
                          public tlm::tlm_fw_transport_if<>,
                          public tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_target_socket<32> from_initiator{"from_initiator"};
  tlm::tlm_initiator_socket<32> to_target{"to_target"};

  TransactionLogger(const sc_core::sc_module_name& name, std::string link,
                    std::vector<LoggedTransaction>& log)
      : sc_module(name), link_(std::move(link)), log_(log) {
    from_initiator.bind(*this);
    to_target.bind(*this);
  }

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override {
    log_.push_back({link_, kernel_time::to_ps(sc_core::sc_time_stamp() + delay), payload.is_write(),
                    payload.get_address()});
    to_target->b_transport(payload, delay);
  }
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return to_target->nb_transport_fw(payload, phase, delay);
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return from_initiator->nb_transport_bw(payload, phase, delay);
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) override {
    return to_target->get_direct_mem_ptr(payload, dmi);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& payload) override {
    return to_target->transport_dbg(payload);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) override {
    from_initiator->invalidate_direct_mem_ptr(start, end);
  }

 private:
  std::string link_;
  std::vector<LoggedTransaction>& log_;
};

// Puts a TransactionLogger into every link that leads to the crossbar of the core or to a bank. It must
// outlive the simulation.
class LoggingBinder : public Binder {
 public:
  void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) override {
    if (link.find("crossbar") == std::string::npos) return Binder::bind(from, to, link);
    loggers_.push_back(std::make_unique<TransactionLogger>((link + "_logger").c_str(), link, log_));
    from.bind(loggers_.back()->from_initiator);
    loggers_.back()->to_target.bind(to);
  }
  // In the order in which they were made, which is not that of their times.
  const std::vector<LoggedTransaction>& log() const { return log_; }

 private:
  std::vector<LoggedTransaction> log_;
  std::vector<std::unique_ptr<TransactionLogger>> loggers_;
};

}  // namespace stereotlm::test
