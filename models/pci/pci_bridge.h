#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/interrupt.h"
#include "models/kernels/integer_rule.h"
#include "models/pci/bridge_registers.h"
#include "models/pci/pci_slot.h"
#include "models/pci/posted_writes.h"
#include "models/words_by_range.h"

namespace stereotlm::pci {

inline constexpr kernels::IntegerRule kDmaBurstRule{1, 1024};
inline constexpr kernels::IntegerRule kPostedWordsRule{1, 4096};

struct PciBridgeConfig {
  // Longest burst of a DMA channel, and of posted writes on the local bus; kDmaBurstRule.
  int dma_burst_words = 32;
  // Words of writes that it can hold, kPostedWordsRule.
  int posted_words = 64;
  // Byte address of the core's registers on the local bus, behind that of every bank.
  std::uint64_t core_registers = std::uint64_t{1} << 34U;
  // On the local bus: words on their way to the banks are counted for each.
  std::vector<AddressRange> buffers = {};
};

// The bridge between the PCI bus and the local bus of the FPGA board (contract section 3, "Bridge");
// registers and descriptors in bridge_registers.h.
//
// - Writes to the slave window are posted: words wait in the bridge, in order, for the local bus; a burst is
//   taken as far as there are free places at its address clock (`stop`), and a word gives its place back at
//   the end of its burst on the local bus. Reads wait until all writes before them have gone, and block until
//   their words are there.
// - A DMA channel fetches a descriptor, then moves its words in bursts. PCI and local bus overlap: one burst
//   can be on either while the last one is on the other.
// - The local bus serves posted writes first, then reads, then the channels in turn; when it has nothing to
//   serve, the turn moves on.
//
// The end of a burst on the local bus is an event only if something waits for it, or it was refused.
//
// Errors are those of bridge_registers.h; a register access that is not one aligned word, or in the wrong
// direction, and a slave access outside the window are answered with an error response.
class PciBridge : public sc_core::sc_module, private PciMasterIf, private PciStopIf, private InterruptIf {
 public:
  struct Stats {
    std::uint64_t posted_words = 0;       // taken from the PCI bus
    std::uint64_t slave_reads = 0;        // words
    std::uint64_t dma_words = 0;          // moved, both directions
    std::uint64_t most_posted_words = 0;  // waiting at one time
    std::uint64_t errors = 0;
  };

  tlm_utils::simple_target_socket<PciBridge> slave{"slave"};
  tlm_utils::simple_target_socket<PciBridge> registers{"registers"};
  sc_core::sc_export<PciStopIf> stop{"stop"};  // of the slave window
  PciMasterPort pci{"pci"};
  tlm_utils::simple_initiator_socket<PciBridge> local{"local"};  // fpga/local_bus.h
  sc_core::sc_in<bool> doorbell{"doorbell"};                     // from the FPGA; rings when it rises
  InterruptOut interrupt{"interrupt"};                           // INTA#

  // Throws std::invalid_argument if the configuration has problems.
  PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config);

  const Stats& stats() const { return stats_; }
  // Words for the banks that have come in, posted or by DMA, and those of them that still wait here for the
  // local bus.
  const WordsByRange& words_taken() const { return words_taken_; }
  WordsByRange words_held() const;

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;

  struct Channel;
  // Words on their way over one of the two buses.
  struct Transfer {
    Channel* channel = nullptr;  // null for the one of the slave window
    bool write = false;
    std::uint64_t address = 0;
    std::vector<std::uint32_t> words = {};
    bool under_way = false;
    bool failed = false;
  };
  // What one descriptor asks for.
  struct Piece {
    bool to_pci = false;
    std::uint64_t pci_address = 0;
    std::uint64_t local_address = 0;
    std::size_t words = 0;
    std::uint32_t next = 0;  // descriptor
  };
  struct Channel {
    std::uint32_t descriptor = 0;
    bool busy = false;
    bool fetching = false;  // the descriptor of the next piece
    Piece piece;
    std::size_t moved = 0;  // words of it, read and on their way or there
    Transfer pci{this};
    Transfer local{this};
  };
  class Manager : public tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload* /*payload*/) override {}
  };

  // As a target of the PCI bus.
  std::size_t writable_words(std::uint64_t address, std::size_t words) const override;
  void slave_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  void post(std::uint64_t offset, const unsigned char* data, std::uint64_t bytes,
            const sc_core::sc_time& delay);
  void register_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  bool read_register(std::uint64_t offset, std::uint32_t& value) const;
  bool write_register(std::uint64_t offset, std::uint32_t value);
  std::uint64_t local_address_of(std::uint64_t offset) const;

  // As a master of it.
  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const BurstResult& result) override;
  void start_on_pci(Transfer& transfer);
  void count_words(WordsByRange& counts, std::uint64_t address, std::size_t words) const;

  // The local bus.
  void start_on_local(Transfer& transfer);
  void wake(const sc_core::sc_time& delay = sc_core::SC_ZERO_TIME);
  void work();
  bool serve();
  void begin(Transfer* transfer, bool write, std::uint64_t address, std::uint32_t* words, std::size_t count);
  tlm::tlm_sync_enum local_response(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                    sc_core::sc_time& delay);
  void answer_at(const sc_core::sc_time& delay);
  bool end_is_awaited() const;
  bool has_ended() const;
  void settle();

  // The channels.
  void start(Channel& channel);
  void finish(Channel& channel, std::uint32_t bits);
  void advance(Channel& channel);
  void fetch(Channel& channel, std::uint32_t descriptor);
  bool take_descriptor(Channel& channel);
  void read_burst(Channel& channel);
  void write_burst(Channel& channel);
  void start_burst(Channel& channel, Transfer& transfer, bool write);

  void ring();
  void raise(std::uint32_t bits);
  bool is_asserted() const override { return (interrupt_status_ & interrupt_enable_) != 0; }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

  PciBridgeConfig config_;
  std::array<std::uint32_t, bridge::kApertures> pages_{};
  std::uint32_t interrupt_status_ = 0;
  std::uint32_t interrupt_enable_ = 0;
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
  PostedWrites posted_;
  Transfer read_;  // of the slave window
  sc_core::sc_event read_ended_{"read_ended"};
  std::array<Channel, bridge::kChannels> channels_;
  std::deque<Transfer*> pci_queue_;
  Transfer* on_pci_ = nullptr;
  std::size_t pci_done_ = 0;              // words of the transfer at the front of the queue
  std::vector<std::uint32_t> pci_words_;  // of the burst under way

  // The burst on the local bus.
  bool local_is_busy_ = false;
  Transfer* on_local_ = nullptr;         // null: posted writes
  std::uint64_t local_end_ps_ = kNever;  // of its idle clock, once it has been answered
  std::size_t next_channel_ = 1;         // the first has been passed over at the start, with nothing to serve
  sc_core::sc_event work_{"work_to_do"};
  Manager manager_;
  tlm::tlm_generic_payload burst_{&manager_};
  WordsByRange words_taken_;
  Stats stats_;
};

}  // namespace stereotlm::pci
