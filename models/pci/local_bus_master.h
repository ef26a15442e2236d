#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstddef>
#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/pci/dma_channel.h"
#include "models/pci/pci_config.h"
#include "models/pci/posted_writes.h"

namespace stereotlm::pci {

// The part of PciBridge that is the only master of the FPGA board's local bus (fpga/local_bus.h). It owns the
// posted writes, and runs one burst at a time: posted writes first, then the read of the slave window, then
// the DMA channels in turn. Channel 1 has the first turn; a burst that ends while nothing waits passes the
// turn on.
//
// The end of a burst costs an event only if the burst was refused or something waits for its end. Otherwise
// the end takes effect in the next call of settle().
class LocalBusMaster : public sc_core::sc_module {
 public:
  // Receives the end of a burst when it takes effect.
  class Listener {
   public:
    virtual ~Listener() = default;
    virtual void posted_write_refused() = 0;
    virtual void local_transfer_ended(DmaChannel& channel) = 0;
  };

  tlm_utils::simple_initiator_socket<LocalBusMaster> bus{"bus"};

  // `config` must have no problems. `channels` and `listener` outlive the master.
  LocalBusMaster(const sc_core::sc_module_name& name, const PciBridgeConfig& config, DmaChannels& channels,
                 Listener& listener);

  const PostedWrites& posted() const { return posted_; }
  // The number of words that can be posted now.
  std::size_t free_places() const;
  // Appends words to the posted writes, at most free_places(). The caller must call settle() before, and
  // send_posted() after.
  void post(std::uint64_t address, const void* words, std::size_t count);
  // Starts to send the posted writes: immediately if the bus is free and `delay` is zero, else when the bus
  // is free or after `delay`.
  void send_posted(const sc_core::sc_time& delay);

  // Reads words after all writes posted before. Waits until the words have arrived. Returns false if the read
  // was refused.
  bool read(std::uint64_t address, void* words, std::size_t count);

  // Starts a DMA transfer, which waits for its turn.
  void start(BridgeTransfer& transfer);
  // Whether the burst of this transfer runs.
  bool runs(const BridgeTransfer& transfer) const { return &transfer == running_; }
  // To be called when the channel of a transfer begins to wait for the end of the transfer.
  void await_end_of(const BridgeTransfer& transfer) {
    if (runs(transfer)) wake();
  }

  // If the end of the running burst has come, ends the burst and begins the next one.
  void settle();

 private:
  static constexpr std::uint64_t kUnknown = UINT64_MAX;

  class Manager : public tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload* /*payload*/) override {}
  };

  void work();
  void wake(const sc_core::sc_time& delay = sc_core::SC_ZERO_TIME);
  bool serve();
  bool serve(BridgeTransfer& transfer);
  void begin(BridgeTransfer* transfer, bool write, std::uint64_t address, std::uint32_t* words,
             std::size_t count);
  tlm::tlm_sync_enum respond(tlm::tlm_generic_payload& burst, tlm::tlm_phase& phase, sc_core::sc_time& delay);
  void end_after(const sc_core::sc_time& delay);
  bool end_is_awaited() const;
  bool has_ended() const;

  std::size_t burst_words_;  // longest burst of posted writes
  std::size_t places_;       // most words of posted writes
  DmaChannels& channels_;
  Listener& listener_;
  PostedWrites posted_;
  BridgeTransfer read_;  // the read of the slave window
  sc_core::sc_event read_ended_{"read_ended"};

  bool busy_ = false;                  // a burst runs
  BridgeTransfer* running_ = nullptr;  // the transfer of that burst; null: posted writes
  std::uint64_t end_ps_ = kUnknown;    // end of that burst's idle clock, known from its response on
  std::size_t turn_ = 1;               // the channel whose turn is next
  sc_core::sc_event work_{"work_to_do"};
  Manager manager_;
  tlm::tlm_generic_payload burst_{&manager_};
};

}  // namespace stereotlm::pci
