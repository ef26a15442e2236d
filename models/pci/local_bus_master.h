#pragma once

#include <cstddef>
#include <cstdint>

namespace stereotlm::pci {

// The origin of a burst on the local bus.
enum class LocalBusSource : std::uint8_t { kPosted, kRead, kDma0, kDma1 };

// Receives what the bridge does as the master of the local bus, for traces. Plain C++.
class LocalBusMasterObserver {
 public:
  virtual ~LocalBusMasterObserver() = default;
  // The words of a write are posted, and wait for the local bus from now on.
  virtual void words_posted(std::uint64_t now_ps, std::size_t words) = 0;
  // A read, or a transfer of a DMA channel, waits for the local bus from now on.
  virtual void transfer_waits(std::uint64_t now_ps, LocalBusSource source) = 0;
  // A burst of this number of words begins. A posted burst takes the words that have waited longest.
  virtual void burst_begins(std::uint64_t now_ps, LocalBusSource source, std::size_t words) = 0;
  // The words of the posted burst under way leave their places at `at_ps`, now or later.
  virtual void posted_words_leave(std::uint64_t at_ps, std::size_t words) = 0;
};

}  // namespace stereotlm::pci
