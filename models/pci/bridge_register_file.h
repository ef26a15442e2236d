#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/pci/bridge_registers.h"
#include "models/pci/dma_channel.h"

namespace stereotlm::pci {

// The registers of the bridge (bridge_registers.h): keeps the pages of the apertures and the interrupt
// registers. Registers of a DMA channel are kept by the channel. Plain C++.
//
// `offset`: a multiple of 4 in the register window.
class BridgeRegisterFile {
 public:
  // `channels` outlives this object.
  explicit BridgeRegisterFile(DmaChannels& channels) : channels_(channels) {}

  // Whether the register exists and can be accessed in this direction.
  static bool allows(bool write, std::uint64_t offset);
  // These need allows().
  std::uint32_t read(std::uint64_t offset) const;
  // Returns the channel whose start bit has been written, or null.
  DmaChannel* write(std::uint64_t offset, std::uint32_t value);

  // The first word on the board that an aperture leads to, as kPage names it.
  std::uint32_t page(std::size_t aperture) const { return pages_[aperture]; }
  // Sets bits of kInterruptStatus.
  void raise(std::uint32_t bits) { interrupt_status_ |= bits; }
  // The level of INTA#.
  bool interrupts() const { return (interrupt_status_ & interrupt_enable_) != 0; }

 private:
  struct Decoded {
    std::uint64_t name = 0;  // offset of the register; of page or channel 0 if it exists for each
    std::size_t index = 0;   // number of the page or channel
  };

  static Decoded decode(std::uint64_t offset);

  DmaChannels& channels_;
  std::array<std::uint32_t, bridge::kApertures> pages_{};
  std::uint32_t interrupt_status_ = 0;
  std::uint32_t interrupt_enable_ = 0;
};

}  // namespace stereotlm::pci
