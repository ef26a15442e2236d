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

#include "models/kernels/integer_rule.h"
#include "models/pci/bridge_registers.h"
#include "models/pci/pci_slot.h"
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

// The bridge between the PCI bus and the local bus of the FPGA board (contract section 3, "Bridge"); registers and
// descriptors in bridge_registers.h.
//
// - Writes to the slave window are posted: words wait in the bridge, in order, for the local bus; a burst is taken as far as
//   there are free places at its address clock (`stop`), and a word gives its place back at the end of its burst on
//   the local bus. Reads wait until all writes before them have gone, and block until their words are there.
// - A DMA channel fetches a descriptor, then moves its words in bursts. PCI and local bus overlap: one burst can be on
//   either while the last one is on the other.
// - The local bus serves posted writes first, then reads, then the channels in turn.
//
// Errors are those of bridge_registers.h; a register access that is not one aligned word, or in the wrong direction, and a
// slave access outside the window are answered with an error response.
class PciBridge : public sc_core::sc_module, private PciMasterIf, private PciStopIf {
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
  sc_core::sc_out<bool> interrupt{"interrupt"};                  // INTA#

  // Throws std::invalid_argument if the configuration has problems.
  PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config);

  const Stats& stats() const { return stats_; }
  // Words for the banks that have come in, posted or by DMA, and those of them that still wait here for the
  // local bus.
  const WordsByRange& words_taken() const { return words_taken_; }
  WordsByRange words_held() const;

 private:
  struct PostedWord {
    std::uint64_t address = 0;  // on the local bus
    std::uint32_t word = 0;
  };
  // Words on their way over one of the two buses.
  struct Transfer {
    bool write = false;
    std::uint64_t address = 0;
    std::vector<std::uint32_t> words;
    bool under_way = false;
    bool on_local_bus = false;
    bool failed = false;
    sc_core::sc_event ended;
  };
  struct Channel {
    std::uint32_t descriptor = 0;
    bool busy = false;
    sc_core::sc_event start;
    Transfer pci;
    Transfer local;
  };
  // What one descriptor asks for.
  struct Piece {
    bool to_pci = false;
    std::uint64_t pci_address = 0;
    std::uint64_t local_address = 0;
    std::size_t words = 0;
  };
  class Manager : public tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload* /*payload*/) override {}
  };

  // As a target of the PCI bus.
  std::size_t writable_words(std::uint64_t address, std::size_t words) const override;
  void slave_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  void register_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  bool read_register(std::uint64_t offset, std::uint32_t& value) const;
  bool write_register(std::uint64_t offset, std::uint32_t value);
  std::uint64_t local_address_of(std::uint64_t offset) const;

  // As a master of it.
  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const BurstResult& result) override;
  void start_on_pci(Transfer& transfer);

  // The local bus.
  void run_local();
  void send_posted();
  bool serve(Transfer& transfer);
  tlm::tlm_response_status move(bool write, std::uint64_t address, std::vector<std::uint32_t>& words);
  tlm::tlm_sync_enum local_response(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                    sc_core::sc_time& delay);
  void start_on_local(Transfer& transfer);

  // The channels.
  void run_channel(std::size_t channel);
  bool run_chain(Channel& channel);
  bool move_piece(Channel& channel, const Piece& piece);
  static bool finish(Transfer& transfer);

  void ring();
  void raise(std::uint32_t bits);
  void drive_interrupt();

  PciBridgeConfig config_;
  std::array<std::uint32_t, bridge::kApertures> pages_{};
  std::uint32_t interrupt_status_ = 0;
  std::uint32_t interrupt_enable_ = 0;
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
  std::deque<PostedWord> posted_;
  std::size_t posted_on_local_bus_ = 0;      // of these, the first
  std::vector<std::uint32_t> posted_burst_;  // of these, on the local bus
  Transfer read_;                            // of the slave window
  std::array<Channel, bridge::kChannels> channels_;
  std::size_t next_channel_ = 0;  // on the local bus
  std::deque<Transfer*> pci_queue_;
  Transfer* on_pci_ = nullptr;
  std::size_t pci_done_ = 0;              // words of the transfer at the front of the queue
  std::vector<std::uint32_t> pci_words_;  // of the burst under way
  sc_core::sc_event work_{"work"};        // for the local bus
  sc_core::sc_event responded_{"responded"};
  Manager manager_;
  tlm::tlm_generic_payload burst_{&manager_};
  WordsByRange words_taken_;
  Stats stats_;
};

}  // namespace stereotlm::pci
