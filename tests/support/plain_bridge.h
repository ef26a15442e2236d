#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/plain_board.h"
#include "tests/support/plain_clock.h"
#include "tests/support/plain_events.h"
#include "tests/support/plain_pci_bus.h"
#include "tests/support/plain_trace.h"

// The PCI bridge and its local bus of contract section 3, one word at a time.
namespace stereotlm::test {

// Addresses on the local bus, in words.
inline constexpr std::uint64_t kPlainBankWords = std::uint64_t{1} << 26U;
inline constexpr std::uint64_t kPlainCoreRegisters = 64 * kPlainBankWords;
constexpr std::uint64_t plain_board_word(const PlainWord& at) {
  return static_cast<std::uint64_t>(at.bank) * kPlainBankWords + at.word;
}

// The core's registers, in words from kPlainCoreRegisters.
enum class PlainCoreRegister : std::uint64_t {
  kControl = 0,
  kStatus = 1,
  kLeftImage = 4,
  kRightImage = 5,
  kDisparity = 6,
  kLeftLut = 7,
  kRightLut = 8,
  kMiddle = 9,  // of PlainMiddle, one after another
};
inline constexpr std::uint32_t kPlainStart = 1;

// Addresses in the bridge's slave window, in words. An aperture holds the largest picture.
inline constexpr std::uint64_t kPlainApertureWords = std::uint64_t{1} << 24U;
inline constexpr std::uint64_t kPlainCoreWindow = 4 * kPlainApertureWords;

// The bridge's registers, in words of its register window.
enum class PlainBridgeRegister : std::uint64_t {
  kPage0 =
      0,  // of part 0 of the left picture, in order the others; kPlainMostParts further, of the right one
  kInterruptStatus = 32,
  kInterruptEnable = 33,
  kDescriptor0 = 36,  // of channel 0; the register of channel 1 is kPlainChannelWords further
  kControl0 = 37,
};
inline constexpr std::uint64_t kPlainMostParts = 16;
inline constexpr std::uint64_t kPlainChannelWords = 4;
inline constexpr std::uint32_t kPlainDoorbell = 1;
inline constexpr std::uint32_t kPlainDmaDone = 2;  // channel 1: the bit above

struct PlainDescriptor {
  std::uint64_t host = 0;   // word of host memory
  std::uint64_t board = 0;  // word of the local bus
  bool to_host = false;
  std::uint64_t words = 0;
};

struct PlainBridgeConfig {
  PlainNumber local_clock_mhz;
  std::size_t dma_burst_words = 0;
  std::size_t posted_words = 0;
  int memory_wait_clocks = 0;
  int words_of_row = 0;  // of a picture
};

class PlainBridge : private PlainMaster {
 public:
  PlainBridge(PlainEvents& events, PlainPciBus& bus, PlainBoard& board, PlainTarget& host_memory,
              const PlainBridgeConfig& config);

  PlainTarget& slave() { return slave_; }
  PlainTarget& registers() { return registers_; }
  // Whether the picture in whose aperture this word lies is striped.
  bool is_striped(std::uint64_t word) const { return pages_.at(word / kPlainApertureWords).size() > 1; }
  // The chain of a channel from its next start on. The channel fetches each descriptor over PCI all the same.
  void set_chain(std::size_t channel, std::vector<PlainDescriptor> chain) {
    channels_[channel].chain = std::move(chain);
  }
  void ring() { status_ |= kPlainDoorbell; }
  bool interrupt() const { return (status_ & enable_) != 0; }

  struct Stats {
    std::uint64_t posted_words = 0;
    std::uint64_t dma_words = 0;
    std::uint64_t local_clocks = 0;
    std::uint64_t local_busy_clocks = 0;
  };
  Stats stats() const;
  const std::vector<PlainBusBurst>& local_bursts() const { return local_bursts_; }
  const std::vector<PlainLevel>& posted_levels() const { return posted_levels_; }

 private:
  struct Slave : PlainTarget {
    explicit Slave(PlainBridge& bridge) : bridge_(bridge) {}
    std::size_t takes(std::size_t words) const override;
    void write(std::uint64_t word, const PlainWords& words) override;
    void read(std::uint64_t word, std::size_t count, PlainTime end_ps,
              std::function<void(PlainWords)> answer) override;
    PlainBridge& bridge_;
  };
  struct Registers : PlainTarget {
    explicit Registers(PlainBridge& bridge) : bridge_(bridge) {}
    void write(std::uint64_t word, const PlainWords& words) override;
    void read(std::uint64_t word, std::size_t count, PlainTime end_ps,
              std::function<void(PlainWords)> answer) override;
    PlainBridge& bridge_;
  };

  struct LocalBurst {
    bool write = false;
    std::uint64_t word = 0;
    PlainWords words;
    std::function<void(PlainWords)> ended;
    std::size_t source = 0;  // see PlainBusBurst
    PlainTime asked_ps = 0;
  };
  struct PciTransfer {
    std::size_t channel = 0;
    bool write = false;
    std::uint64_t word = 0;  // of host memory
    PlainWords words;
    std::size_t done = 0;
  };
  struct PostedWord {
    std::uint64_t word = 0;
    std::uint32_t value = 0;
    PlainTime posted_ps = 0;
  };
  struct Channel {
    std::vector<PlainDescriptor> chain;
    bool busy = false;
    std::size_t descriptor = 0;  // of the chain
    bool fetching = false;
    std::uint64_t moved = 0;  // words of the descriptor whose write has begun
    bool on_pci = false;
    bool on_local = false;
    PlainWords words;  // read, and their write has not begun
    std::optional<LocalBurst> asks;
  };

  // The local bus.
  void ask();
  bool serve();
  void begin(LocalBurst burst);
  void await_word(PlainTime end_ps);
  void word_ends(PlainTime begin_ps, PlainTime usable_ps);
  void end();

  // The channels.
  void start(std::size_t channel);
  void proceed(std::size_t channel);
  void fetch(std::size_t channel);
  void read_burst(std::size_t channel);
  void write_burst(std::size_t channel);
  void start_on_pci(std::size_t channel, bool write, std::uint64_t word, PlainWords words);
  void start_on_local(std::size_t channel, bool write, std::uint64_t word, PlainWords words);
  PlainBurst burst() override;
  void ended(const PlainWords& words) override;

  PlainEvents& events_;
  PlainPciBus& bus_;
  PlainBoard& board_;
  PlainTarget& host_memory_;
  PlainBridgeConfig config_;
  PlainClock clock_;
  std::size_t master_;
  Slave slave_{*this};
  Registers registers_{*this};

  std::array<PlainParts, 2> pages_;  // of the apertures of both pictures
  std::uint32_t status_ = 0;
  std::uint32_t enable_ = 0;

  std::deque<PostedWord> posted_;  // not yet on the local bus
  std::size_t posted_on_local_ = 0;
  std::optional<LocalBurst> read_;  // of the slave window
  std::array<Channel, 2> channels_;
  std::size_t next_channel_ = 1;
  std::deque<PciTransfer> transfers_;

  std::optional<LocalBurst> local_;  // the burst on the local bus
  std::uint64_t address_clock_ = 0;
  std::optional<std::uint64_t> idle_clock_;  // once it is known
  std::size_t word_ = 0;                     // of the burst
  Stats stats_;
  std::vector<PlainBusBurst> local_bursts_;  // that have ended
  std::vector<PlainLevel> posted_levels_;
};

}  // namespace stereotlm::test
