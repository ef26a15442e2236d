#include "models/pci/direct_memories.h"

#include <cstring>
#include <systemc>

namespace stereotlm::pci {

bool DirectMemories::access(std::size_t window, tlm::tlm_generic_payload& access) const {
  const Grant& grant = grants_[window];
  const std::uint64_t first = access.get_address();
  const std::size_t bytes = access.get_data_length();
  if (grant.data == nullptr || first < grant.first || first + bytes - 1 > grant.last) return false;
  unsigned char* const stored = grant.data + (first - grant.first);
  unsigned char* const words = access.get_data_ptr();
  std::memcpy(access.is_write() ? stored : words, access.is_write() ? words : stored, bytes);
  return true;
}

void DirectMemories::request(std::size_t window, tlm::tlm_fw_direct_mem_if<tlm::tlm_generic_payload>& target,
                             tlm::tlm_generic_payload& access) {
  tlm::tlm_dmi dmi;
  const bool granted = target.get_direct_mem_ptr(access, dmi);
  if (!granted || !dmi.is_read_write_allowed() || dmi.get_read_latency() != sc_core::SC_ZERO_TIME ||
      dmi.get_write_latency() != sc_core::SC_ZERO_TIME) {
    return;
  }
  grants_[window] = {dmi.get_dmi_ptr(), dmi.get_start_address(), dmi.get_end_address()};
}

}  // namespace stereotlm::pci
