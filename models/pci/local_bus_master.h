#pragma once

#include <cstddef>
#include <cstdint>

#include "models/local_burst.h"
#include "models/pci/dma_channel.h"
#include "models/pci/pci_config.h"
#include "models/pci/posted_writes.h"
#include "models/time_ps.h"

namespace stereotlm::pci {

// The origin of a burst on the local bus.
enum class LocalBusSource : std::uint8_t { kPosted, kRead, kDma0, kDma1 };

// Receives what LocalBusMaster does, for traces. Plain C++.
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

// The part of BridgeControl that is the only master of the FPGA board's local bus. It owns the posted writes,
// and runs one burst at a time: posted writes first, then the read of the slave window, then the DMA channels
// in turn. Channel 1 has the first turn; a burst that ends while nothing waits passes the turn on. Plain C++.
//
// The end of a burst costs a step only if the burst was refused or something waits for its end. Otherwise the
// end takes effect in the next call of settle().
class LocalBusMaster final : public LocalBusMasterIf {
 public:
  // Receives the end of a burst when it takes effect.
  class Listener {
   public:
    virtual ~Listener() = default;
    virtual void posted_write_refused(std::uint64_t now_ps) = 0;
    virtual void slave_read_ended(std::uint64_t now_ps, const BridgeTransfer& read) = 0;
    virtual void local_transfer_ended(std::uint64_t now_ps, DmaChannel& channel) = 0;
  };

  // `config` must have no problems. `channels`, `bus` and `listener` outlive the master.
  LocalBusMaster(const PciBridgeConfig& config, DmaChannels& channels, LocalBusIf& bus, Listener& listener);

  // `observer` outlives the master.
  void observe(LocalBusMasterObserver& observer) { observer_ = &observer; }

  const PostedWrites& posted() const { return posted_; }
  // The number of words that can be posted now.
  std::size_t free_places(std::uint64_t now_ps) const;
  // Appends words to the posted writes, at most free_places(). The caller must call settle() before, and
  // send_posted() after.
  void post(std::uint64_t address, const void* words, std::size_t count) {
    posted_.push(address, words, count);
  }
  // `words` words have been posted. Starts to send them, immediately if the bus is free.
  void send_posted(std::uint64_t now_ps, std::size_t words);

  // Reads words after all writes posted before. To be called if no other read is under way.
  void read(std::uint64_t now_ps, std::uint64_t address, std::size_t count);
  // Starts a DMA transfer, which waits for its turn.
  void start(std::uint64_t now_ps, BridgeTransfer& transfer);
  // Whether the burst of this transfer runs.
  bool runs(const BridgeTransfer& transfer) const { return &transfer == running_; }
  // To be called when a channel begins to wait for the end of its transfer.
  void await_end() {
    if (busy_) plan();
  }

  // Whether no burst runs and none waits. To be called after settle(), while no DMA channel is busy.
  bool is_idle() const { return !busy_ && !posted_.waits() && !read_.under_way; }
  // The channel whose turn is next, while it is idle.
  std::size_t turn() const { return turn_; }
  void set_turn(std::size_t turn) { turn_ = turn; }

  // If the end of the running burst has come, ends the burst and begins the next one.
  void settle(std::uint64_t now_ps) {
    if (has_ended(now_ps)) end(now_ps);
  }

  std::uint64_t next_ps() const { return next_ps_; }
  // Whether step() ends a burst; else it chooses one.
  bool ends_next() const { return busy_; }
  void step(std::uint64_t now_ps);

  void end_burst_at(std::uint64_t end_ps, bool ok) override;

 private:
  bool serve(std::uint64_t now_ps);
  bool serve(std::uint64_t now_ps, BridgeTransfer& transfer);
  void begin(std::uint64_t now_ps, BridgeTransfer* transfer, const LocalBurst& burst);
  // Without an observer these cost nothing beside the branches around them.
  [[gnu::cold, gnu::noinline]] void report_start(std::uint64_t now_ps, const BridgeTransfer& transfer) const;
  [[gnu::cold, gnu::noinline]] void report_begin(std::uint64_t now_ps, std::size_t words) const;
  [[gnu::cold, gnu::noinline]] void report_end() const;
  LocalBusSource source_of(const BridgeTransfer& transfer) const;
  void end(std::uint64_t now_ps);
  void plan();
  bool end_is_awaited() const;
  bool has_ended(std::uint64_t now_ps) const { return busy_ && end_ps_ <= now_ps; }

  std::size_t burst_words_;  // longest burst of posted writes
  DmaChannels& channels_;
  LocalBusIf& bus_;
  Listener& listener_;
  LocalBusMasterObserver* observer_ = nullptr;
  PostedWrites posted_;
  BridgeTransfer read_;  // the read of the slave window

  bool busy_ = false;                  // a burst runs
  BridgeTransfer* running_ = nullptr;  // the transfer of that burst; null: posted writes
  bool ok_ = true;                     // that burst was not refused, as far as is known
  std::uint64_t end_ps_ = kNever;      // end of that burst's idle clock; kNever until it is known
  std::size_t turn_ = 1;               // the channel whose turn is next
  std::uint64_t next_ps_ = kNever;
};

}  // namespace stereotlm::pci
