#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/bridge_buses.h"
#include "platform/fast_board.h"

namespace stereotlm::platform {

// Skips bursts of a DMA transfer that repeat what an earlier burst did.
//
// A DMA channel writes a burst on one bus while it reads the next one on the other. Its next step begins when
// both have ended. If no other transfer disturbs it, one bus always ends last, and sets the pace: the steps
// begin a fixed number of its clocks apart. On the other bus each burst begins with the first clock at or
// after the step, and takes a fixed number of clocks.
//
// So one step is recorded: the clocks that it takes on each bus, and what it counts. A later step that begins
// alike repeats it, and so do all steps behind it. They are skipped at once.
//
// This holds only for steps that nothing else touches:
// - Nothing else is under way in the bridge, on the local bus or on the PCI bus.
// - The bursts are of full length, and move words between host memory and one bank. The bank serves one word
//   a cycle, beside the frame of the core. The local bus and the core must have the same clock.
// - The bus that waits for the other one waits for a clock at least. Then their order does not depend on how
//   their clocks lie against each other.
// - While they last, no other master requests the PCI bus, and no other block has an event.
// The last two bursts of a descriptor are always stepped.
class DmaBursts {
 public:
  // `host_memory` has `host_memory_bytes` bytes. `has_pixels`: whether the words that are skipped are written
  // to host memory; those for banks always are, because tables decide the timing. The other arguments outlive
  // this object.
  DmaBursts(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
            unsigned char* host_memory, std::uint64_t host_memory_bytes, bool has_pixels);

  // To be called before the local bus chooses a burst, at `now_ps`. Before `end_ps` nothing but the PCI bus
  // and the bridge has an event. Returns true if it has skipped bursts: then the bus chooses later.
  bool skip(std::uint64_t now_ps, std::uint64_t end_ps);

  // The number of steps skipped.
  std::uint64_t skipped() const { return skipped_; }

 private:
  // How a step begins. Steps that begin alike take the same clocks.
  struct Beginning {
    unsigned channel = 0;
    bool to_pci = false;
    std::size_t bank = 0;
    std::size_t turn = 0;          // on the local bus
    std::size_t last_granted = 0;  // master of the PCI bus
    // Whether the PCI bus is free one clock after the request: a burst on it has ended just now.
    bool waits_for_pci = false;

    friend bool operator==(const Beginning& a, const Beginning& b) {
      return a.channel == b.channel && a.to_pci == b.to_pci && a.bank == b.bank && a.turn == b.turn &&
             a.last_granted == b.last_granted && a.waits_for_pci == b.waits_for_pci;
    }
  };
  // What a step does. Clocks are counted from the first one at or after its beginning.
  struct Step {
    std::uint64_t pci_free = 0;    // the PCI bus is free
    std::uint64_t local_free = 0;  // the local bus is free
    std::uint64_t first_word = 0;  // of the local bus: the first word requests its bank
    std::uint64_t wait_clocks = 0;
    std::uint64_t pci_busy = 0;
    std::uint64_t local_busy = 0;
  };
  // The state in which a step began.
  struct Before {
    std::uint64_t now_ps = 0;
    pci::PciBusControl::MasterCounts counts;
    BusCounts buses;
  };

  std::optional<Beginning> beginning(std::uint64_t now_ps, const pci::DmaChannel& channel) const;
  std::optional<Step> recorded(std::size_t burst_words) const;
  bool keeps_pace(const Step& step) const;
  const Clock& pace() const { return beginning_.waits_for_pci ? buses_.pci_clock() : buses_.local_clock(); }
  std::uint64_t period() const { return beginning_.waits_for_pci ? step_->pci_free - 1 : step_->local_free; }
  void apply(std::uint64_t now_ps, pci::DmaChannel& channel, std::size_t steps);
  void move_words(pci::DmaChannel& channel, std::size_t words, std::uint32_t* in_bank);

  unsigned char* host_words(const pci::DmaChannel& channel, std::size_t word) const {
    return host_memory_ + (channel.moving().pci_address - host_base_) + 4 * word;
  }

  BridgeBuses buses_;
  pci::BridgeControl& bridge_;
  FastBoard& board_;
  unsigned char* host_memory_;
  std::uint64_t host_base_;
  std::uint64_t host_end_;
  bool has_pixels_;

  Beginning beginning_;       // of the last step
  Before before_;             // the state then
  std::optional<Step> step_;  // what the steps that begin like that one do, if they can be skipped
  std::vector<fpga::HostPort::ServedWords> bursts_;  // that are recorded
  std::uint64_t skipped_ = 0;
};

}  // namespace stereotlm::platform
