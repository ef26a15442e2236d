#pragma once

#include <cstdint>
#include <tlm>

namespace stereotlm::memory {

// Returns a pointer to `bytes` bytes from `address` on in the memory behind a socket (DMI). The pointer is
// for immediate use only, because the target may revoke it. Null if the target does not grant all these bytes
// for this command.
inline unsigned char* direct_memory(tlm::tlm_initiator_socket<32>& socket, tlm::tlm_command command,
                                    std::uint64_t address, std::uint64_t bytes) {
  tlm::tlm_generic_payload access;
  access.set_command(command);
  access.set_address(address);
  tlm::tlm_dmi dmi;
  if (!socket->get_direct_mem_ptr(access, dmi)) return nullptr;
  const bool allowed = command == tlm::TLM_READ_COMMAND ? dmi.is_read_allowed() : dmi.is_write_allowed();
  if (!allowed || address < dmi.get_start_address() || address + bytes - 1 > dmi.get_end_address())
    return nullptr;
  return dmi.get_dmi_ptr() + (address - dmi.get_start_address());
}

}  // namespace stereotlm::memory
