#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/pci/bridge_registers.h"

namespace stereotlm::pci {

// What a descriptor tells a DMA channel to move.
struct DmaDescriptor {
  bool to_pci = false;
  std::uint64_t pci_address = 0;    // of the first byte
  std::uint64_t local_address = 0;  // the same, on the local bus
  std::size_t words = 0;
  std::uint32_t next = 0;  // PCI address of the next descriptor; 0: none
};

// Receives what a bridge does, for recordings. Plain C++.
class BridgeObserver {
 public:
  virtual ~BridgeObserver() = default;
  // The program has started a channel, which fetches its first descriptor.
  virtual void dma_started(unsigned channel, std::uint64_t now_ps) = 0;
  // The descriptor is read. Its fetch began at `begin_ps`.
  virtual void transfer_begun(unsigned channel, std::uint64_t begin_ps, const DmaDescriptor& moved) = 0;
  // The last word of the transfer that the channel has begun is written.
  virtual void transfer_ended(unsigned channel, std::uint64_t now_ps) = 0;
  // `interrupts`: bits of kInterruptStatus.
  virtual void interrupts_raised(std::uint64_t now_ps, std::uint32_t interrupts) = 0;
  virtual void interrupts_cleared(std::uint64_t now_ps, std::uint32_t interrupts) = 0;
};

class DmaChannel;

// Words that the bridge moves over one of its two buses.
struct BridgeTransfer {
  DmaChannel* channel = nullptr;  // null: a read of the slave window
  bool write = false;
  std::uint64_t address = 0;  // first byte, as an address on that bus
  std::vector<std::uint32_t> words = {};
  bool under_way = false;  // from its start to its end
  bool failed = false;     // whether a target has refused it; valid once it has ended
};

// One DMA channel of the bridge. It follows a chain of descriptors (bridge_registers.h) and splits the words
// of each descriptor into bursts. While it writes a burst on one bus, it reads the next burst on the other
// bus; both must end before its next step.
//
// The channel decides, and the bridge acts: each step names the transfers that the bridge is to start, and
// the bridge calls next_step() when one of them has ended. Times are only for the observer. Plain C++.
class DmaChannel {
 public:
  struct Step {
    std::array<BridgeTransfer*, 2> starts = {};  // transfers to start, in this order; null: none
    std::uint32_t interrupts = 0;                // bits of kInterruptStatus to raise
  };

  // `number`: 0..kChannels-1. `burst_words`: the longest burst, in words.
  DmaChannel(unsigned number, std::size_t burst_words) : number_(number), burst_words_(burst_words) {}
  DmaChannel(const DmaChannel&) = delete;
  DmaChannel& operator=(const DmaChannel&) = delete;

  // `observer` outlives the channel.
  void observe(BridgeObserver& observer) { observer_ = &observer; }

  // The register kDmaDescriptor. It names the chain that the next start() follows.
  std::uint32_t descriptor() const { return descriptor_; }
  void set_descriptor(std::uint32_t address) { descriptor_ = address; }
  bool busy() const { return busy_; }

  // To be called when the start bit of kDmaControl is written. A busy channel raises kDmaError and continues
  // its chain.
  Step start(std::uint64_t now_ps) {
    if (busy_) return {{}, bridge::kDmaError << number_};
    busy_ = true;
    pci_.failed = false;
    local_.failed = false;
    if (observer_ != nullptr) observer_->dma_started(number_, now_ps);
    return fetch(now_ps, descriptor_);
  }
  // To be called when a transfer of this channel has ended. The step is empty while the other transfer is
  // under way.
  Step next_step(std::uint64_t now_ps) {
    if (!busy_ || pci_.under_way || local_.under_way) return {};
    if (pci_.failed || local_.failed) return finish(bridge::kDmaError);
    if (fetching_) {
      fetching_ = false;
      if (!decode_descriptor()) return finish(bridge::kDmaError);
      if (observer_ != nullptr) observer_->transfer_begun(number_, fetch_ps_, moving_);
      return {{&read_burst()}, 0};
    }
    if (written_ < moving_.words) {
      Step step{{&write_burst()}, 0};
      if (written_ < moving_.words) step.starts[1] = &read_burst();
      return step;
    }
    return end_descriptor(now_ps);
  }

  unsigned number() const { return number_; }
  BridgeTransfer& on_pci() { return pci_; }
  BridgeTransfer& on_local_bus() { return local_; }
  const BridgeTransfer& on_local_bus() const { return local_; }
  // Whether only its transfer on the local bus keeps the channel from its next step.
  bool waits_for_local_bus() const { return local_.under_way && !pci_.under_way; }

 private:
  Step finish(std::uint32_t interrupt) {
    busy_ = false;
    return {{}, interrupt << number_};
  }
  Step fetch(std::uint64_t now_ps, std::uint32_t address) {
    if (address % 16 != 0) return finish(bridge::kDmaError);
    fetch_ps_ = now_ps;
    fetching_ = true;
    pci_.write = false;
    pci_.address = address;
    pci_.words.resize(4);
    return {{&pci_}, 0};
  }
  bool decode_descriptor() {
    const std::vector<std::uint32_t>& words = pci_.words;
    moving_.pci_address = words[0];
    moving_.local_address = bridge::local_address(words[1]);
    moving_.to_pci = (words[2] & bridge::kToPci) != 0;
    moving_.words = words[2] & ~bridge::kToPci;
    moving_.next = words[3];
    written_ = 0;
    return moving_.words != 0 && moving_.pci_address % 4 == 0;
  }
  Step end_descriptor(std::uint64_t now_ps) {
    if (observer_ != nullptr) observer_->transfer_ended(number_, now_ps);
    return moving_.next != 0 ? fetch(now_ps, moving_.next) : finish(bridge::kDmaDone);
  }
  BridgeTransfer& source() { return moving_.to_pci ? local_ : pci_; }
  BridgeTransfer& read_burst() {
    source().words.resize(std::min(burst_words_, moving_.words - written_));
    return prepare(source(), false);
  }
  // Writes the words that the last burst has read.
  BridgeTransfer& write_burst() {
    BridgeTransfer& to = moving_.to_pci ? pci_ : local_;
    to.words.swap(source().words);
    prepare(to, true);
    written_ += to.words.size();
    return to;
  }
  BridgeTransfer& prepare(BridgeTransfer& transfer, bool write) const {
    transfer.write = write;
    transfer.address = (&transfer == &pci_ ? moving_.pci_address : moving_.local_address) + written_ * 4;
    return transfer;
  }

  unsigned number_;
  std::size_t burst_words_;
  std::uint32_t descriptor_ = 0;
  bool busy_ = false;
  bool fetching_ = false;       // pci_ reads a descriptor
  DmaDescriptor moving_;        // whose words are moved
  std::size_t written_ = 0;     // words of moving_ whose write has begun
  std::uint64_t fetch_ps_ = 0;  // the fetch of moving_ began
  BridgeObserver* observer_ = nullptr;
  BridgeTransfer pci_{this};
  BridgeTransfer local_{this};
};

using DmaChannels = std::array<DmaChannel, bridge::kChannels>;

}  // namespace stereotlm::pci
