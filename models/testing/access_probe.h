#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>
#include <unordered_map>
#include <vector>

namespace stereotlm::test {

// An access that a probe has seen. Times are absolute: that at which it was requested, and that of its
// response.
struct SeenAccess {
  sc_core::sc_time begin;                                            // of the request
  sc_core::sc_time end;                                              // of the response
  bool write = false;                                                // true: a write; false: a read
  std::uint64_t address = 0;                                         // as the initiator requested it
  std::vector<std::uint32_t> words;                                  // words written or read
  tlm::tlm_response_status response = tlm::TLM_INCOMPLETE_RESPONSE;  // response of the target
};

// Stands in a link of the base protocol: forwards every call unchanged, takes no time, and keeps each access
// by b_transport or nb_transport once it has its response. Debug transport and DMI are not kept.
class AccessProbe : public sc_core::sc_module,
                    public tlm::tlm_fw_transport_if<>,
                    public tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_target_socket<32> from_initiator{"from_initiator"};  // from the initiator of the link
  tlm::tlm_initiator_socket<32> to_target{"to_target"};         // to the target of the link

  explicit AccessProbe(const sc_core::sc_module_name& name);  // both sockets must be bound

  // In the order of their responses.
  const std::vector<SeenAccess>& accesses() const { return accesses_; }

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) override {
    return to_target->get_direct_mem_ptr(payload, dmi);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& payload) override {
    return to_target->transport_dbg(payload);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) override {
    from_initiator->invalidate_direct_mem_ptr(start, end);
  }

 protected:
  // An access that began at `begin`, at this address, has its response, which counts from `end` on. An
  // interconnect behind the probe may have changed the address in the payload.
  virtual void ended(const tlm::tlm_generic_payload& payload, std::uint64_t address,
                     const sc_core::sc_time& begin, const sc_core::sc_time& end);

 private:
  struct Begun {
    std::uint64_t address;
    sc_core::sc_time begin;
  };
  void end(const tlm::tlm_generic_payload& payload, const sc_core::sc_time& delay);

  std::vector<SeenAccess> accesses_;
  std::unordered_map<const tlm::tlm_generic_payload*, Begun> begun_;  // by nb_transport
};

}  // namespace stereotlm::test
