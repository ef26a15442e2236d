#pragma once

#include <array>
#include <cstdint>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// Remembers for each port whether the words that it watches may have changed. Plain C++.
class ChangeWatch {
 public:
  // Whether the words at byte addresses first .. end - 1 on the crossbar may have changed since the last call
  // for this port. True in the first call, and if the last call was for other addresses.
  bool may_have_changed(Port port, std::uint64_t first, std::uint64_t end) {
    Watch& watch = watches_[port];
    const bool is_new = watch.first != first || watch.end != end;
    const bool changed = watch.changed || is_new;
    watch = {first, end, false};
    return changed;
  }
  // To be called when these words may have changed.
  void changes(std::uint64_t first, std::uint64_t bytes) {
    for (Watch& watch : watches_)
      watch.changed = watch.changed || (first < watch.end && watch.first < first + bytes);
  }

 private:
  struct Watch {
    std::uint64_t first = 0;
    std::uint64_t end = 0;
    bool changed = true;
  };

  std::array<Watch, kMostPorts> watches_{};
};

}  // namespace stereotlm::memory
