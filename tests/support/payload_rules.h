#pragma once

#include <string>
#include <tlm>
#include <vector>

namespace stereotlm::test {

// What a link is held to beyond the base protocol itself.
struct ProtocolOptions {
  // Data length, streaming width and address are whole 32-bit words, as on every memory-mapped socket here.
  bool whole_words = true;
  // A streaming width below the data length (a streaming burst, 14.15) is meant.
  bool streaming_bursts = false;
  // The far side is an interconnect that translates addresses; without one the address comes back as sent
  // (14.7).
  bool address_may_change = false;
};

// One sentence per broken rule: what was found, the rule, and its clause of IEEE Std 1666-2011. Empty: none.
using Problems = std::vector<std::string>;

// The payload as an initiator must present it to b_transport and with BEGIN_REQ.
Problems request_problems(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options);

// The payload as a target must leave it with its response.
Problems response_problems(const tlm::tlm_generic_payload& payload);

Problems debug_request_problems(const tlm::tlm_generic_payload& payload);
Problems debug_answer_problems(const tlm::tlm_generic_payload& payload, unsigned int bytes);

Problems dmi_request_problems(const tlm::tlm_generic_payload& payload, const tlm::tlm_dmi& dmi);
// `address` is the one that was asked for: an interconnect may have translated the payload's.
Problems dmi_answer_problems(const tlm::tlm_generic_payload& payload, sc_dt::uint64 address, bool granted,
                             const tlm::tlm_dmi& dmi);

// What nobody but the initiator may change while a transaction lives (14.7). Copies the data of a write and
// the byte enables, so the payload's arrays must be valid as far as their pointers are not null.
class PayloadSnapshot {
 public:
  explicit PayloadSnapshot(const tlm::tlm_generic_payload& payload);
  sc_dt::uint64 address() const { return address_; }
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

}  // namespace stereotlm::test
