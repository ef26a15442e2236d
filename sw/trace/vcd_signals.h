#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "models/fpga/conflict_recorder.h"
#include "platform/trace_records.h"
#include "sw/trace/trace_board.h"

namespace stereotlm::trace {

enum class VcdGroup : std::uint8_t { kBanks, kPorts, kQueues, kBuses };
inline constexpr std::array<const char*, 4> kVcdGroupNames = {"banks", "ports", "queues", "buses"};

// A signal of a waveform. Its value is a number, or the number of a word.
struct VcdSignal {
  VcdGroup group = VcdGroup::kBanks;
  std::string scope;
  std::string name;
  unsigned bits = 0;       // 0: its values are words
  std::uint32_t idle = 0;  // its value outside of the window
};

// The signals of a board, and the words that they show. A value is kNoNumber
// while a signal has no number, and kUnknown before its first change in the window.
class VcdSignals {
 public:
  static constexpr std::uint32_t kNoNumber = UINT32_MAX;
  static constexpr std::uint32_t kUnknown = UINT32_MAX - 1;
  static constexpr std::size_t kNone = SIZE_MAX;

  // Indices of the signals of a port, in this order from its first one.
  enum PortSignal : std::uint8_t { kState, kBank, kAddress, kWaitsFor, kPortSignals };
  // Of a bank: a bank with separate ports has two owners.
  enum BankSignal : std::uint8_t { kRequests, kOwner, kWriteOwner };
  enum BusSignal : std::uint8_t { kBusOwner, kPhase, kDirection, kTarget, kBusAddress };

  explicit VcdSignals(const TraceBoard& board);

  const std::vector<VcdSignal>& all() const { return signals_; }
  // The signals of the core come first.
  std::size_t core_size() const { return core_size_; }
  // The first signal of a port; kNone if the port does not exist.
  std::size_t port(std::size_t port) const { return ports_[port]; }
  std::size_t bank(std::size_t bank) const { return banks_[bank]; }
  std::size_t host_traffic() const { return host_traffic_; }
  std::size_t lane(std::size_t side) const { return first_queue_ + side; }
  std::size_t results() const { return first_queue_ + 2; }
  std::size_t works() const { return first_queue_ + 3; }
  std::size_t bus(platform::BusBurst::Bus bus) const { return buses_[static_cast<std::size_t>(bus)]; }
  // The signal of a queue of the computer. Throws std::invalid_argument if it has none.
  std::size_t queue(std::string_view name) const;

  // The number of a word, which is added if it is new. A space becomes an underscore, because a word of a
  // waveform has none.
  std::uint32_t word(std::string_view text);
  const std::string& text(std::uint32_t word) const { return words_[word]; }

 private:
  std::size_t add(VcdGroup group, std::string scope, std::string name, unsigned bits, std::uint32_t idle);
  std::size_t add_words(VcdGroup group, const std::string& scope, const std::string& name,
                        std::string_view idle) {
    return add(group, scope, name, 0, word(idle));
  }
  void add_ports(const TraceBoard& board);
  void add_banks(const TraceBoard& board);
  void add_computer();

  std::vector<VcdSignal> signals_;
  std::vector<std::string> words_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::size_t core_size_ = 0;
  std::array<std::size_t, fpga::kPortCount> ports_{};
  std::vector<std::size_t> banks_;
  std::size_t host_traffic_ = 0;
  std::size_t first_queue_ = 0;
  std::array<std::size_t, 2> buses_{};
  std::size_t first_level_ = 0;
};

}  // namespace stereotlm::trace
