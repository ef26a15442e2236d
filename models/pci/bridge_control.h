#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/local_burst.h"
#include "models/pci/bridge_registers.h"
#include "models/pci/dma_channel.h"
#include "models/pci/local_bus_master.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot.h"
#include "models/pci/posted_writes.h"
#include "models/time_ps.h"
#include "models/words_by_range.h"

namespace stereotlm::pci {

// The timing of PciBridge (contract section 3, "Bridge"), its registers and its counters. Plain C++.
//
// - Writes to the slave window are posted: their words wait in the bridge, in order, for the local bus. A
//   word frees its place when its burst on the local bus ends. A read waits until all writes before it have
//   left.
// - A DMA channel fetches a descriptor, then moves its words in bursts (dma_channel.h). Both channels share
//   one PCI master, which serves their transfers in the order in which they start.
// - The bridge is the only master of the local bus, and runs one burst at a time: posted writes first, then
//   the read of the slave window, then the DMA channels in turn. Channel 1 has the first turn; a burst that
//   ends while nothing waits passes the turn on. The end of a burst costs a step only if the burst was
//   refused or something waits for its end. Otherwise it takes effect in the next call that uses the bus.
//
// Errors of posted writes and of DMA set bits of kInterruptStatus.
class BridgeControl final : public PciMasterIf, public PciTarget, public LocalBusMasterIf {
 public:
  // What the bridge has counted since time 0.
  struct Stats {
    std::uint64_t posted_words = 0;  // words of writes that the slave window took
    std::uint64_t slave_reads = 0;   // words read through the slave window
    std::uint64_t dma_words = 0;     // words whose write by a DMA channel has begun, both directions
    std::uint64_t errors = 0;        // refused accesses and raised errors
  };

  // Receives what the bridge signals to the host.
  class Host {
   public:
    virtual ~Host() = default;
    // The words of the read are in place. `ok`: the local bus has not refused it.
    virtual void slave_read_ended(std::uint64_t now_ps, bool ok) = 0;
    // The level of INTA# has changed.
    virtual void interrupt_changed(std::uint64_t now_ps) = 0;
  };

  // `slot` is that of the PCI bus, for the DMA channels. These outlive the control. `config` must have no
  // problems.
  BridgeControl(const PciBridgeConfig& config, PciSlot& slot, LocalBusIf& local_bus, Host& host);

  // `observer` outlives the bridge.
  void observe(BridgeObserver& observer);
  void observe(LocalBusMasterObserver& observer) { local_observer_ = &observer; }

  // The receiver of the local bus's answers.
  LocalBusMasterIf& local_bus_master() { return *this; }
  void end_burst_at(std::uint64_t end_ps, bool ok) override;

  // The slave window. `offset`: a multiple of 4; the words are inside the window.
  //
  // How many of the `words` words of a write have free places now, and lie in the row of the first one if the
  // picture is striped. STOP# ends the write after these.
  std::size_t postable_words(std::uint64_t now_ps, std::uint64_t offset, std::size_t words) const;
  // Posts a write. Returns false, without effect, if it has more words than there are free places.
  bool write(std::uint64_t now_ps, std::uint64_t offset, const unsigned char* data, std::size_t words);
  // Begins a read, which ends with Host::slave_read_ended(). `data` must stay until then. To be called if no
  // other read is under way.
  void read(std::uint64_t now_ps, std::uint64_t offset, unsigned char* data, std::size_t words);

  // The register window. Refuses, and counts, an access that is not one word of a register with this
  // direction.
  PciAnswer access(std::uint64_t now_ps, const PciAccess& access, std::uint64_t at_ps) override;

  // Counts an access that was refused before it came here.
  void count_error() { ++stats_.errors; }
  // The rising edge of the FPGA's doorbell.
  void ring(std::uint64_t now_ps) { raise(now_ps, bridge::kDoorbell); }
  // The level of INTA#.
  bool interrupts() const { return interrupts_; }

  // When step() is to be called: the local bus ends a burst that something waits for, or chooses a burst.
  std::uint64_t next_ps() const { return next_ps_; }
  // Whether step() ends a burst; else it chooses one.
  bool ends_next() const { return busy_; }
  void step(std::uint64_t now_ps);

  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const BurstResult& result) override;

  const Stats& stats() const { return stats_; }  // counts up to the last call
  // The words for the banks that the bridge has received, posted or by DMA, counted by buffer.
  const WordsByRange& words_taken() const { return words_taken_; }
  // The part of words_taken() that still waits in the bridge for the local bus.
  WordsByRange words_held() const;

 private:
  // A register. `name`: its offset; if each page or channel has one, that of number 0. `index`: the number of
  // the page or channel.
  struct Register {
    std::uint64_t name = 0;
    std::size_t index = 0;
  };
  static Register decode(std::uint64_t offset);
  // Whether the register exists and can be accessed in this direction.
  static bool allows(bool write, std::uint64_t offset);
  std::uint32_t read_register(const Register& its) const;
  void write_register(std::uint64_t now_ps, const Register& its, std::uint32_t value);

  std::uint64_t local_address_of(std::uint64_t offset) const;
  // The offset behind the last word of the slave window from this one on that leads to contiguous addresses.
  std::uint64_t border_behind(std::uint64_t offset) const;
  // Counts words from this address on. Words for the core's registers are not counted.
  void count_for_banks(WordsByRange& counts, std::uint64_t address, std::uint64_t words) const {
    if (address < config_.core_registers)
      counts.add(address, std::min(words, (config_.core_registers - address) / 4));
  }
  void raise(std::uint64_t now_ps, std::uint32_t interrupts);
  void drive_interrupts(std::uint64_t now_ps);

  // These run the DMA channels.
  void run(std::uint64_t now_ps, const DmaChannel::Step& step);
  void advance(std::uint64_t now_ps, DmaChannel& channel);
  void start_on_pci(std::uint64_t now_ps, BridgeTransfer& transfer);

  // These are the master of the local bus.
  std::size_t free_places(std::uint64_t now_ps) const;
  void start_on_local_bus(std::uint64_t now_ps, BridgeTransfer& transfer);
  bool serve(std::uint64_t now_ps);
  bool serve(std::uint64_t now_ps, BridgeTransfer& transfer);
  void begin(std::uint64_t now_ps, BridgeTransfer* transfer, const LocalBurst& burst);
  void end_local(std::uint64_t now_ps);
  // If the burst on the local bus is due to end by `now_ps`, ends it and begins the next one.
  void settle(std::uint64_t now_ps) {
    if (has_ended(now_ps)) end_local(now_ps);
  }
  // Names the time of the next step while a burst runs.
  void plan() { next_ps_ = end_is_awaited() ? end_ps_ : kNever; }
  bool end_is_awaited() const;
  bool has_ended(std::uint64_t now_ps) const { return busy_ && end_ps_ <= now_ps; }
  LocalBusSource source_of(const BridgeTransfer* transfer) const;

  PciBridgeConfig config_;
  PciSlot& slot_;
  LocalBusIf& local_bus_;
  Host& host_;
  DmaChannels channels_;
  // [aperture][part]: as kPage and kNextPage name them.
  std::array<std::vector<std::uint32_t>, bridge::kApertures> pages_;
  std::uint32_t interrupt_status_ = 0;
  std::uint32_t interrupt_enable_ = 0;
  bool interrupts_ = false;  // the level of INTA#
  PostedWrites posted_;
  BridgeTransfer read_;                 // the read of the slave window
  unsigned char* read_data_ = nullptr;  // and its destination
  // The DMA transfers on PCI, null behind the last one; the first one runs. A channel has one at most.
  std::array<BridgeTransfer*, bridge::kChannels> pci_queue_{};
  std::size_t pci_done_ = 0;              // words of the running transfer that have been transferred
  std::vector<std::uint32_t> pci_words_;  // words of its burst

  bool busy_ = false;                  // a burst runs on the local bus
  BridgeTransfer* running_ = nullptr;  // the transfer of that burst; null: posted writes
  bool ok_ = true;                     // that burst was not refused, as far as is known
  std::uint64_t end_ps_ = kNever;      // end of that burst's idle clock; kNever until it is known
  std::size_t turn_ = 1;               // the channel whose turn is next
  std::uint64_t next_ps_ = kNever;

  WordsByRange words_taken_;
  BridgeObserver* observer_ = nullptr;
  LocalBusMasterObserver* local_observer_ = nullptr;
  Stats stats_;
};

}  // namespace stereotlm::pci
