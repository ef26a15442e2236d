#pragma once

#include <cstddef>
#include <cstdint>
#include <tlm>
#include <vector>

namespace stereotlm::pci {

// Keeps the DMI grants of the targets behind the windows of a PciBus. A grant is kept only if it covers reads
// and writes and both take no time.
class DirectMemories {
 public:
  explicit DirectMemories(std::size_t windows) : grants_(windows) {}

  bool has(std::size_t window) const { return grants_[window].data != nullptr; }
  // Carries out a read or write. Returns false, without effect, unless all its bytes lie in the granted
  // memory.
  bool access(std::size_t window, tlm::tlm_generic_payload& access) const;
  // Asks the target of a window for DMI to the memory at the address of `access`.
  void request(std::size_t window, tlm::tlm_fw_direct_mem_if<tlm::tlm_generic_payload>& target,
               tlm::tlm_generic_payload& access);
  // Drops all grants. To be called when a target has invalidated its grant.
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
