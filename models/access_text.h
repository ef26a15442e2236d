#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <tlm>

namespace stereotlm {

// Returns an address as 0x7ffde068, in every locale.
inline std::string hex(std::uint64_t address) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "0x%llx", static_cast<unsigned long long>(address));
  return text.data();
}

// What an access asks for: "a read of 4 bytes at address 0x10".
inline std::string access_text(const tlm::tlm_generic_payload& access) {
  const char* const command = access.is_read()    ? "a read of "
                              : access.is_write() ? "a write of "
                                                  : "a command with ";
  return command + std::to_string(access.get_data_length()) + " bytes at address " +
         hex(access.get_address());
}

}  // namespace stereotlm
