#pragma once

#include <cstdint>
#include <string>
#include <tlm>

namespace stereotlm {

// The accesses that a memory-mapped target takes.
struct AccessRules {
  std::uint64_t end = UINT64_MAX;  // the first address behind the target
  bool one_word = false;           // one word of 32 bits; else any number of them
  bool byte_enables = false;       // with or without byte enables; else without
};

// Returns TLM_OK_RESPONSE, or the response for the first rule that an access breaks:
//
// | rule                                                             | response otherwise             |
// |------------------------------------------------------------------|--------------------------------|
// | it reads or writes                                               | TLM_COMMAND_ERROR_RESPONSE     |
// | its length is whole words, as many as the target takes, and its  | TLM_BURST_ERROR_RESPONSE       |
// | streaming width is not smaller                                   |                                |
// | its byte enables are allowed, and their length is not 0          | TLM_BYTE_ENABLE_ERROR_RESPONSE |
// | its address is a multiple of 4, and all its bytes are in the     | TLM_ADDRESS_ERROR_RESPONSE     |
// | target                                                           |                                |
inline tlm::tlm_response_status check_access(const tlm::tlm_generic_payload& access,
                                             const AccessRules& rules) {
  const std::uint64_t address = access.get_address();
  const unsigned length = access.get_data_length();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (length == 0 || length % 4 != 0 || (rules.one_word && length != 4) ||
      access.get_streaming_width() < length)
    return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr &&
      (!rules.byte_enables || access.get_byte_enable_length() == 0))
    return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (address % 4 != 0 || address > rules.end || length > rules.end - address)
    return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

// "a read or write of whole words of 4 bytes, below address 64, without byte enables".
inline std::string text_of(const AccessRules& rules) {
  return std::string("a read or write of ") + (rules.one_word ? "one word" : "whole words") +
         " of 4 bytes at a multiple of 4" +
         (rules.end == UINT64_MAX ? "" : ", below address " + std::to_string(rules.end)) +
         (rules.byte_enables ? "" : ", without byte enables");
}

// The rules of 32-bit registers at the byte addresses 0, 4, .. below `end`.
constexpr AccessRules registers_below(std::uint64_t end) { return {end, true, false}; }

}  // namespace stereotlm
