#pragma once

#include <cstdint>
#include <tlm>

namespace stereotlm {

// What every bank of 32-bit registers at the byte addresses 0, 4, .. below `end` asks of an access: a read or
// write (else TLM_COMMAND_ERROR_RESPONSE) of 4 bytes, streaming width not below it
// (TLM_BURST_ERROR_RESPONSE), without byte enables (TLM_BYTE_ENABLE_ERROR_RESPONSE), at the address of a
// register (TLM_ADDRESS_ERROR_RESPONSE).
inline tlm::tlm_response_status check_register_access(const tlm::tlm_generic_payload& access,
                                                      std::uint64_t end) {
  const std::uint64_t address = access.get_address();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (access.get_data_length() != 4 || access.get_streaming_width() < 4) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (address % 4 != 0 || address >= end) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

}  // namespace stereotlm
