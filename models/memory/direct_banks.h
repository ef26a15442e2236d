#pragma once

#include <cstddef>
#include <cstdint>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// Direct access to the words of the banks, by their byte addresses on the crossbar. Plain C++.
class DirectBanks {
 public:
  virtual ~DirectBanks() = default;
  // Returns a pointer to these bytes, for immediate use only; null if the bank does not grant direct access
  // to all of them. The caller reports writes with changes(), and accesses with count_direct().
  virtual unsigned char* direct(std::uint64_t address, std::uint64_t bytes) = 0;
  // To be called when these words have been written by direct access.
  virtual void changes(std::uint64_t first, std::uint64_t bytes) = 0;
  // Counts accesses to a bank.
  virtual void count_direct(std::size_t bank, std::uint64_t accesses) = 0;
  // Allows the port one access that is not direct, in the current cycle.
  virtual void allow_access(Port port) = 0;
};

}  // namespace stereotlm::memory
