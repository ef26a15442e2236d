#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// Direct access to the words of the banks, by their byte addresses on the crossbar. Plain C++.
class DirectBanks {
 public:
  explicit DirectBanks(std::size_t banks) : direct_accesses_(banks) {}  // `banks`: their number
  virtual ~DirectBanks() = default;

  // Returns a pointer to these bytes, for immediate use only; null if the bank does not grant direct access,
  // for reads and writes, to all of them. The caller reports writes with changes(), and accesses with
  // count_direct().
  virtual unsigned char* direct(std::uint64_t address, std::uint64_t bytes) = 0;
  // Allows the port one access that is not direct, in the current cycle.
  virtual void allow_access(Port port) = 0;

  // To be called when these words may have changed.
  void changes(std::uint64_t first, std::uint64_t bytes) {
    for (Watch& watch : watches_)
      watch.changed = watch.changed || (first < watch.end && watch.first < first + bytes);
  }
  // Whether the words at byte addresses first .. end - 1 may have changed since the last call for this port.
  // True in the first call, and if the last call was for other addresses.
  bool may_have_changed(Port port, std::uint64_t first, std::uint64_t end) {
    if (port >= watches_.size()) watches_.resize(port + 1);
    Watch& watch = watches_[port];
    const bool changed = watch.changed || watch.first != first || watch.end != end;
    watch = {first, end, false};
    return changed;
  }
  // Counts accesses to a bank.
  void count_direct(std::size_t bank, std::uint64_t accesses) { direct_accesses_[bank] += accesses; }
  std::uint64_t direct_accesses(std::size_t bank) const { return direct_accesses_[bank]; }

 private:
  // The words that a port watches.
  struct Watch {
    std::uint64_t first = 0;
    std::uint64_t end = 0;
    bool changed = true;
  };

  std::vector<Watch> watches_;
  std::vector<std::uint64_t> direct_accesses_;  // [bank]
};

}  // namespace stereotlm::memory
