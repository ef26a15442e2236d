#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

namespace stereotlm::test {

// An access that a target must refuse, and the expected response.
struct RefusedAccess {
  tlm::tlm_response_status response = tlm::TLM_INCOMPLETE_RESPONSE;
  tlm::tlm_command command = tlm::TLM_READ_COMMAND;
  std::uint64_t address = 0;
  unsigned length = 4;
  unsigned streaming_width = 4;
  int byte_enables = -1;  // length of the byte enables; -1: none
};

// Sends the access by b_transport. Expects that the target refuses it at once and leaves the data unchanged.
inline void expect_refused(tlm::tlm_initiator_socket<32>& socket, const RefusedAccess& access) {
  const std::vector<std::uint32_t> before(access.length / 4 + 1, 0xA5A5'A5A5);
  std::vector<std::uint32_t> words = before;
  std::vector<unsigned char> enables(4, TLM_BYTE_ENABLED);
  tlm::tlm_generic_payload payload;
  payload.set_command(access.command);
  payload.set_address(access.address);
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  payload.set_data_length(access.length);
  payload.set_streaming_width(access.streaming_width);
  if (access.byte_enables >= 0) {
    payload.set_byte_enable_ptr(enables.data());
    payload.set_byte_enable_length(static_cast<unsigned>(access.byte_enables));
  }
  sc_core::sc_time delay;
  const sc_dt::uint64 now = sc_core::sc_time_stamp().value();
  socket->b_transport(payload, delay);
  EXPECT_EQ(payload.get_response_status(), access.response)
      << "command " << access.command << " at " << access.address << ", length " << access.length
      << ", streaming width " << access.streaming_width << ", byte enables " << access.byte_enables;
  EXPECT_EQ((sc_core::sc_time_stamp() + delay).value(), now);
  EXPECT_EQ(words, before);
}

}  // namespace stereotlm::test
