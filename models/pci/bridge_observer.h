#pragma once

#include <cstdint>

namespace stereotlm::pci {

// The words of one descriptor, which a DMA channel moves.
struct DmaTransfer {
  unsigned channel = 0;
  std::uint64_t begin_ps = 0;  // the fetch of the descriptor begins
  bool to_pci = false;
  std::uint64_t local_address = 0;  // first byte, on the local bus
  std::uint64_t words = 0;
};

// Receives what a bridge does, for recordings. Plain C++.
class BridgeObserver {
 public:
  virtual ~BridgeObserver() = default;
  // The program has started a channel, which fetches its first descriptor.
  virtual void dma_started(unsigned channel, std::uint64_t now_ps) = 0;
  // The descriptor is read.
  virtual void transfer_begun(const DmaTransfer& transfer) = 0;
  // The last word of the transfer that the channel has begun is written.
  virtual void transfer_ended(unsigned channel, std::uint64_t now_ps) = 0;
  // `interrupts`: bits of kInterruptStatus.
  virtual void interrupts_raised(std::uint64_t now_ps, std::uint32_t interrupts) = 0;
  virtual void interrupts_cleared(std::uint64_t now_ps, std::uint32_t interrupts) = 0;
};

}  // namespace stereotlm::pci
