#pragma once

#include <cstdint>
#include <tlm>

namespace stereotlm {

// The accesses that a memory-mapped target takes.
struct AccessRules {
  std::uint64_t end = UINT64_MAX;  // the first address behind the target
  bool one_word = false;           // one word of 32 bits; else any number of them
  bool byte_enables = false;       // with or without byte enables; else without
};

// The first rule that an access breaks.
struct BrokenRule {
  tlm::tlm_response_status response = tlm::TLM_OK_RESPONSE;  // that of the access; OK: it breaks none
  const char* text = "";                                     // text of the rule
};

// | rule                                                             | response otherwise             |
// |------------------------------------------------------------------|--------------------------------|
// | it reads or writes                                               | TLM_COMMAND_ERROR_RESPONSE     |
// | its data pointer is not null                                     | TLM_GENERIC_ERROR_RESPONSE     |
// | its length is whole words, as many as the target takes, and its  | TLM_BURST_ERROR_RESPONSE       |
// | streaming width is not smaller                                   |                                |
// | its byte enables are allowed, and their length is not 0          | TLM_BYTE_ENABLE_ERROR_RESPONSE |
// | its address is a multiple of 4, and all its bytes are in the     | TLM_ADDRESS_ERROR_RESPONSE     |
// | target                                                           |                                |
inline BrokenRule broken_rule(const tlm::tlm_generic_payload& access, const AccessRules& rules) {
  const std::uint64_t address = access.get_address();
  const unsigned length = access.get_data_length();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND)
    return {tlm::TLM_COMMAND_ERROR_RESPONSE, "must be a read or a write"};
  if (access.get_data_ptr() == nullptr)
    return {tlm::TLM_GENERIC_ERROR_RESPONSE, "the data pointer must not be null"};
  if (length == 0 || length % 4 != 0)
    return {tlm::TLM_BURST_ERROR_RESPONSE, "the length must be whole words of 4 bytes"};
  if (rules.one_word && length != 4)
    return {tlm::TLM_BURST_ERROR_RESPONSE, "the length must be one word of 4 bytes"};
  if (access.get_streaming_width() < length)
    return {tlm::TLM_BURST_ERROR_RESPONSE, "the streaming width must be at least the length"};
  if (access.get_byte_enable_ptr() != nullptr && !rules.byte_enables)
    return {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, "byte enables are not taken"};
  if (access.get_byte_enable_ptr() != nullptr && access.get_byte_enable_length() == 0)
    return {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, "the length of the byte enables must not be 0"};
  if (address % 4 != 0) return {tlm::TLM_ADDRESS_ERROR_RESPONSE, "the address must be a multiple of 4"};
  if (address > rules.end || length > rules.end - address)
    return {tlm::TLM_ADDRESS_ERROR_RESPONSE, "all bytes must be in the target"};
  return {};
}
// Its response alone.
inline tlm::tlm_response_status check_access(const tlm::tlm_generic_payload& access,
                                             const AccessRules& rules) {
  return broken_rule(access, rules).response;
}

// The rules of 32-bit registers at the byte addresses 0, 4, .. below `end`.
constexpr AccessRules registers_below(std::uint64_t end) { return {end, true, false}; }

}  // namespace stereotlm
