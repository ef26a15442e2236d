#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/interrupt.h"
#include "models/pci/bridge_registers.h"
#include "models/pci/dma_channel.h"

namespace stereotlm::pci {

// The register window of the bridge (bridge_registers.h): decodes accesses, keeps the pages of the apertures
// and the interrupt registers, and drives INTA#. Registers of a DMA channel are kept by the channel.
class BridgeRegisterFile : public InterruptIf {
 public:
  // `channels` outlives this object.
  explicit BridgeRegisterFile(DmaChannels& channels) : channels_(channels) {}

  // Carries out an access and sets its response status. An access is refused without effect if it is not one
  // aligned word of a register, or has the wrong direction. Returns the channel whose start bit has been
  // written, or null.
  DmaChannel* access(tlm::tlm_generic_payload& access);

  // The first word on the board that an aperture leads to, as kPage names it.
  std::uint32_t page(std::size_t aperture) const { return pages_[aperture]; }
  // Sets bits of kInterruptStatus.
  void raise(std::uint32_t bits);

  bool is_asserted() const override { return (interrupt_status_ & interrupt_enable_) != 0; }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

 private:
  struct Decoded {
    std::uint64_t name = 0;  // offset of the register; of page or channel 0 if it exists for each
    std::size_t index = 0;   // number of the page or channel
  };

  static Decoded decode(std::uint64_t offset);
  static bool allows(const tlm::tlm_generic_payload& access, std::uint64_t name);
  std::uint32_t read(const Decoded& at) const;
  DmaChannel* write(const Decoded& at, std::uint32_t value);

  DmaChannels& channels_;
  std::array<std::uint32_t, bridge::kApertures> pages_{};
  std::uint32_t interrupt_status_ = 0;
  std::uint32_t interrupt_enable_ = 0;
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
};

}  // namespace stereotlm::pci
