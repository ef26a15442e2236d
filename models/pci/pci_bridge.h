#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/interrupt.h"
#include "models/pci/bridge_register_file.h"
#include "models/pci/dma_channel.h"
#include "models/pci/local_bus_master.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"
#include "models/words_by_range.h"

namespace stereotlm::pci {

// The bridge between the PCI bus and the local bus of the FPGA board (contract section 3, "Bridge"). Its
// registers and descriptors are in bridge_registers.h.
//
// - Writes to the slave window are posted: their words wait in the bridge, in order, for the local bus. The
//   bridge takes as many words of a burst as it has free places at the address clock (`stop`). A word frees
//   its place when its burst on the local bus ends. A read waits until all writes before it have left, and
//   blocks until its words have arrived.
// - A DMA channel fetches a descriptor, then moves its words in bursts (dma_channel.h). Both channels share
//   one PCI master, which serves their transfers in the order in which they start.
// - LocalBusMaster arbitrates the local bus.
//
// Errors of posted writes and of DMA set bits of kInterruptStatus. These accesses have an error response and
// no effect: a register access that is not one aligned word or has the wrong direction, a slave access
// outside the window, and a posted write of more words than there are free places.
class PciBridge : public sc_core::sc_module,
                  private PciMasterIf,
                  private PciStopIf,
                  private LocalBusMaster::Listener {
 public:
  struct Stats {
    std::uint64_t posted_words = 0;       // words of writes that the slave window took
    std::uint64_t slave_reads = 0;        // words read through the slave window
    std::uint64_t dma_words = 0;          // words whose write by a DMA channel has begun, both directions
    std::uint64_t most_posted_words = 0;  // the most posted words that waited at one time
    std::uint64_t errors = 0;             // refused accesses and raised errors
  };

  tlm_utils::simple_target_socket<PciBridge> slave{"slave"};
  tlm_utils::simple_target_socket<PciBridge> registers{"registers"};
  sc_core::sc_export<PciStopIf> stop{"stop"};    // STOP# of the slave window
  PciMasterPort pci{"pci"};                      // bus mastering of the DMA channels
  tlm::tlm_initiator_socket<32> local{"local"};  // to fpga/local_bus.h
  sc_core::sc_in<bool> doorbell{"doorbell"};     // from the FPGA; its rising edge raises kDoorbell
  InterruptOut interrupt{"interrupt"};           // INTA#

  // Throws std::invalid_argument if the configuration has problems.
  PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config);

  const Stats& stats() const { return stats_; }
  // The words for the banks that the bridge has received, posted or by DMA, counted by buffer.
  const WordsByRange& words_taken() const { return words_taken_; }
  // The part of words_taken() that still waits in the bridge for the local bus.
  WordsByRange words_held() const;

 private:
  // These serve the slave window and the register window.
  std::size_t writable_words(std::uint64_t address, std::size_t words) const override;
  void access_slave(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  tlm::tlm_response_status check_slave(const tlm::tlm_generic_payload& access) const;
  void post(std::uint64_t offset, const unsigned char* data, std::uint64_t bytes,
            const sc_core::sc_time& delay);
  std::uint64_t local_address_of(std::uint64_t offset) const;
  void count_for_banks(WordsByRange& counts, std::uint64_t address, std::size_t words) const;
  void access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  void ring() { raise(bridge::kDoorbell); }
  void raise(std::uint32_t interrupts);

  // These run the DMA channels.
  void run(const DmaChannel::Step& step);
  void advance(DmaChannel& channel);
  void start_on_pci(BridgeTransfer& transfer);
  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const BurstResult& result) override;
  void local_transfer_ended(DmaChannel& channel) override { advance(channel); }
  void posted_write_refused() override { raise(bridge::kPostedError); }

  PciBridgeConfig config_;
  DmaChannels channels_;
  BridgeRegisterFile register_file_{channels_};
  LocalBusMaster local_bus_;
  std::deque<BridgeTransfer*> pci_queue_;  // DMA transfers on PCI; the first one runs
  std::size_t pci_done_ = 0;               // words of the running transfer that have been transferred
  std::vector<std::uint32_t> pci_words_;   // words of its burst
  WordsByRange words_taken_;
  Stats stats_;
};

}  // namespace stereotlm::pci
