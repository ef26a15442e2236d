#pragma once

#include <cstdint>
#include <tlm>

namespace stereotlm {

// Checks an access to 32-bit registers at the byte addresses 0, 4, .. below `end`. Returns TLM_OK_RESPONSE,
// or the response for the first rule that the access breaks:
//
// | rule                                                 | response otherwise             |
// |------------------------------------------------------|--------------------------------|
// | it reads or writes                                   | TLM_COMMAND_ERROR_RESPONSE     |
// | its length is 4, its streaming width at least 4      | TLM_BURST_ERROR_RESPONSE       |
// | it has no byte enables                               | TLM_BYTE_ENABLE_ERROR_RESPONSE |
// | its address is that of a register                    | TLM_ADDRESS_ERROR_RESPONSE     |
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
