#pragma once

#include <string>
#include <systemc>
#include <tlm>
#include <vector>

namespace stereotlm::test {

// Rules of a link in addition to the rules of the base protocol.
struct ProtocolOptions {
  // Data length, streaming width and address are whole 32-bit words, as on every memory-mapped socket here,
  // and the streaming width is at least the data length. Without it streaming bursts are allowed too (14.15).
  bool whole_words = true;
  // The address stays as it was sent, as above a target. Without it an interconnect below may translate it
  // in place (14.7 d, e).
  bool fixed_address = true;
  // A response has a final status. Without it TLM_INCOMPLETE_RESPONSE is an answer too: what acted as the
  // target did not attempt the command (14.17 e).
  bool final_status = true;
  // Each access ends before the simulation. Without it one may be under way when a test ends the simulation.
  bool all_end = true;
};

// One sentence per broken rule: the value found, the rule, and its clause of IEEE Std 1666-2011.
using Problems = std::vector<std::string>;

// Rules for the initiator's payload in b_transport and with BEGIN_REQ.
Problems request_problems(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options);

// Rules for the payload that a target returns with its response.
Problems response_problems(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options);

// The rule that an access breaks if it has not ended at the end of the simulation.
std::string open_problem(sc_dt::uint64 address, const sc_core::sc_time& begin);

// Rules for transport_dbg, and for the number of bytes that it returns.
Problems debug_request_problems(const tlm::tlm_generic_payload& payload);
Problems debug_answer_problems(const tlm::tlm_generic_payload& payload, unsigned int bytes);

// Rules for get_direct_mem_ptr.
Problems dmi_request_problems(const tlm::tlm_generic_payload& payload, const tlm::tlm_dmi& dmi);
// `address` is the requested address; an interconnect may have translated the address in the payload.
Problems dmi_answer_problems(const tlm::tlm_generic_payload& payload, sc_dt::uint64 address, bool granted,
                             const tlm::tlm_dmi& dmi);

// The fields that only the initiator may change during a transaction (14.7). The constructor copies the data
// of a write and the byte enables: arrays whose pointers are not null must be valid.
class PayloadSnapshot {
 public:
  // Taken at the request. A request that does not use an array may have a pointer to what is not there.
  explicit PayloadSnapshot(const tlm::tlm_generic_payload& payload, bool uses_data = true,
                           bool uses_enables = true);
  sc_dt::uint64 address() const { return address_; }  // as requested
  // A sentence for each changed field.
  Problems changes(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options) const;

 private:
  tlm::tlm_command command_;
  sc_dt::uint64 address_;
  const unsigned char* data_;
  unsigned int data_length_;
  unsigned int streaming_width_;
  const unsigned char* byte_enables_;
  unsigned int byte_enable_length_;
  tlm::tlm_gp_option gp_option_;
  std::vector<unsigned char> written_;
  std::vector<unsigned char> enables_;
};

// What a target may set until it has sent its response, and nobody after that (14.7 g).
class ResponseSnapshot {
 public:
  explicit ResponseSnapshot(const tlm::tlm_generic_payload& payload);  // taken at the response
  // A sentence for each changed field.
  Problems changes(const tlm::tlm_generic_payload& payload) const;

 private:
  tlm::tlm_response_status status_;
  bool dmi_allowed_;
  const unsigned char* data_;
  std::vector<unsigned char> read_;
};

}  // namespace stereotlm::test
