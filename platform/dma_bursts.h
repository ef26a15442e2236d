#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/bus_counts.h"
#include "platform/fast_board.h"

namespace stereotlm::platform {

// Skips bursts of a DMA transfer that repeat what an earlier burst did.
//
// A DMA channel writes a burst on one bus while it reads the next one on the other. Its next step begins when
// both have ended. If nothing disturbs the channel, the same bus always ends last, and sets the pace: the
// steps begin a fixed number of its clocks apart. On the other bus each burst begins with the first clock at
// or after the step, and takes a fixed number of clocks.
//
// So one step is recorded: the clocks that it takes on each bus, and what it counts. The steps behind it that
// begin alike are skipped at once.
//
// This holds only for steps that nothing else touches:
// - Nothing else is under way in the bridge, on the local bus or on the PCI bus.
// - The bursts are of full length, and move words between host memory and one bank. The bank serves one word
//   a cycle: the running frame does not use it, or the host has the highest fixed priority.
// - The bus that ends first ends a clock earlier at least. Then it ends first wherever its clocks lie against
//   those of the other bus.
// - Until the last of them ends, no other master requests the PCI bus, and no other block has an event.
// The last two bursts of a descriptor are always stepped.
class DmaBursts {
 public:
  // `host_memory` has `host_memory_bytes` bytes. All arguments outlive this object.
  DmaBursts(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
            unsigned char* host_memory, std::uint64_t host_memory_bytes);

  // To be called before the local bus chooses a burst, at `now_ps`. Before `end_ps` only the PCI bus and the
  // bridge have events. Returns true if it has skipped bursts: then the local bus chooses later.
  bool skip(std::uint64_t now_ps, std::uint64_t end_ps);

  // The number of steps skipped.
  std::uint64_t skipped() const { return skipped_; }

 private:
  // How a step begins: its bank, whether it reads from the bank, the channel that has the next turn on the
  // local bus, and whether a burst on the PCI bus ends just then. Steps that begin alike take the same
  // clocks.
  using Beginning = std::tuple<std::size_t, bool, std::size_t, bool>;
  // What a step does. Clocks are counted from the first one at or after its beginning.
  struct Step {
    std::uint64_t pci_end = 0;     // the burst on the PCI bus ends
    std::uint64_t local_free = 0;  // the local bus is free
    std::uint64_t first_word = 0;  // of the local bus: the first word requests its bank
    std::uint64_t wait_clocks = 0;
    BusCounts buses;
  };
  // The state in which a step began.
  struct Before {
    std::uint64_t now_ps = 0;
    pci::PciBusControl::MasterCounts counts;
    BusCounts buses;
  };

  std::optional<Beginning> beginning() const;
  std::optional<Step> recorded() const;
  bool pci_ends_last() const { return std::get<3>(beginning_); }
  const Clock& pace() const { return pci_ends_last() ? pci_bus_.clock() : local_bus_.clock(); }
  std::uint64_t period() const { return pci_ends_last() ? step_->pci_end : step_->local_free; }
  void apply(std::uint64_t now_ps, std::uint64_t steps);
  void move_words(std::uint64_t words, unsigned char* in_bank);

  pci::PciBusControl& pci_bus_;
  fpga::LocalBusControl& local_bus_;
  pci::BridgeControl& bridge_;
  FastBoard& board_;
  unsigned char* host_memory_;
  std::uint64_t host_memory_bytes_;

  pci::DmaChannel* channel_ = nullptr;  // whose step begins
  Beginning beginning_{};               // of its last step
  Before before_;
  std::optional<Step> step_;  // what steps that begin like that one do, if they can be skipped
  std::vector<fpga::HostPort::SkippedBurst> bursts_;  // of apply()
  std::uint64_t skipped_ = 0;
};

}  // namespace stereotlm::platform
