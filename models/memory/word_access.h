#pragma once

#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>

namespace stereotlm::memory {

// Makes the 32-bit accesses of one initiator socket, with one transaction object that is set up once.
class WordAccess {
 public:
  // `socket` outlives this object.
  explicit WordAccess(tlm::tlm_initiator_socket<32>& socket) : socket_(socket) {
    access_.set_data_ptr(reinterpret_cast<unsigned char*>(&word_));
    access_.set_data_length(4);
    access_.set_streaming_width(4);
    access_.set_byte_enable_ptr(nullptr);
    access_.set_byte_enable_length(0);
  }

  // `delay`: time of the access, from now; the target adds the time that it takes. Returns false if the
  // target refuses the access: status() is the reason, and word() is 0 after a read.
  bool read(std::uint64_t address, sc_core::sc_time& delay) {
    word_ = 0;
    return transport(tlm::TLM_READ_COMMAND, address, delay);
  }
  bool write(std::uint64_t address, std::uint32_t word, sc_core::sc_time& delay) {  // the same for a write
    word_ = word;
    return transport(tlm::TLM_WRITE_COMMAND, address, delay);
  }
  std::uint32_t word() const { return word_; }  // last word read or written
  tlm::tlm_response_status status() const { return access_.get_response_status(); }  // of the last access
  std::string status_text() const { return access_.get_response_string(); }          // as text

 private:
  bool transport(tlm::tlm_command command, std::uint64_t address, sc_core::sc_time& delay) {
    // The target is looked up only once: the path through the socket and the virtual bases of its interface
    // costs as much as an access.
    if (target_ == nullptr) target_ = socket_.operator->();
    access_.set_command(command);
    access_.set_address(address);
    access_.set_dmi_allowed(false);
    access_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    target_->b_transport(access_, delay);
    return access_.is_response_ok();
  }

  tlm::tlm_initiator_socket<32>& socket_;
  tlm::tlm_blocking_transport_if<>* target_ = nullptr;
  std::uint32_t word_ = 0;
  tlm::tlm_generic_payload access_;
};

}  // namespace stereotlm::memory
