#pragma once

#include <cstddef>
#include <cstdint>
#include <tlm>
#include <vector>

namespace stereotlm::pci {

// Memory that the targets behind the windows of a bus have granted for direct access (DMI). A grant is kept
// only if it covers reads and writes and both take no time.
class DirectMemories {
 public:
  explicit DirectMemories(std::size_t windows) : grants_(windows) {}

  bool has(std::size_t window) const { return grants_[window].data != nullptr; }
  // Carries out a read or write. False, without effect, unless all its bytes lie in the granted memory.
  bool access(std::size_t window, tlm::tlm_generic_payload& access) const;
  // Asks the target of a window for the memory at the address of an access.
  void request(std::size_t window, tlm::tlm_fw_direct_mem_if<tlm::tlm_generic_payload>& target,
               tlm::tlm_generic_payload& access);
  // The targets have invalidated their grants.
  void forget() { grants_.assign(grants_.size(), {}); }

 private:
  struct Grant {
    unsigned char* data = nullptr;  // the byte at address `first`; null: no grant
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };

  std::vector<Grant> grants_;  // [window]
};

}  // namespace stereotlm::pci
