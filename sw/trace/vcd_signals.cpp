#include "sw/trace/vcd_signals.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::trace {
namespace {

constexpr unsigned kBusAddressBits = 32;
constexpr unsigned kCountBits = 16;
constexpr unsigned kRequestBits = 3;
static_assert(fpga::kPortCount < 1U << kRequestBits);
static_assert(fpga::kLaneFifoRule.max < 1 << kCountBits && fpga::kResultFifoRule.max < 1 << kCountBits);

// The queues of the computer, as QueueLevel names them, and the names of their signals.
constexpr std::array<std::array<const char*, 2>, 3> kQueues = {
    {{"left_capture", "fifo"}, {"right_capture", "fifo"}, {"posted", "words"}}};

// Bits of a byte address in the largest bank.
unsigned address_bits(const TraceBoard& board) {
  unsigned bits = 1;
  for (const platform::BankConfig& bank : board.banks) {
    while (std::uint64_t{1} << bits < 4 * static_cast<std::uint64_t>(bank.words)) ++bits;
  }
  return bits;
}

}  // namespace

VcdSignals::VcdSignals(const TraceBoard& board) {
  add_banks(board);
  add_ports(board);
  first_queue_ = add(VcdGroup::kQueues, "left_lane", "slots", kCountBits, 0);
  add(VcdGroup::kQueues, "right_lane", "slots", kCountBits, 0);
  add(VcdGroup::kQueues, "results", "words", kCountBits, 0);
  add(VcdGroup::kQueues, "matcher", "works", 1, 0);
  core_size_ = signals_.size();
  add_computer();
}

void VcdSignals::add_banks(const TraceBoard& board) {
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const std::string& name = board.bank_name(bank);
    banks_.push_back(add(VcdGroup::kBanks, name, "requests", kRequestBits, 0));
    if (board.has_separate_ports(bank)) {
      add_words(VcdGroup::kBanks, name, "read_owner", "-");
      add_words(VcdGroup::kBanks, name, "write_owner", "-");
    } else {
      add_words(VcdGroup::kBanks, name, "owner", "-");
    }
  }
}

void VcdSignals::add_ports(const TraceBoard& board) {
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    ports_[port] = kNone;
    if (!fpga::has_port(board.core, port)) continue;
    const std::string name = fpga::kPorts[port].name;
    ports_[port] = add_words(VcdGroup::kPorts, name, "state", "idle");
    add_words(VcdGroup::kPorts, name, "bank", "-");
    add(VcdGroup::kPorts, name, "address", address_bits(board), kUnknown);
    add_words(VcdGroup::kPorts, name, "waits_for", "-");
  }
  host_traffic_ = add_words(VcdGroup::kPorts, "host", "traffic", "-");
}

void VcdSignals::add_computer() {
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
    const std::string name = bus == 0 ? "pci" : "local_bus";
    buses_[bus] = add_words(VcdGroup::kBuses, name, "owner", "-");
    add_words(VcdGroup::kBuses, name, "phase", "idle");
    add_words(VcdGroup::kBuses, name, "direction", "-");
    add_words(VcdGroup::kBuses, name, "target", "-");
    add(VcdGroup::kBuses, name, "address", kBusAddressBits, kNoNumber);
  }
  first_level_ = signals_.size();
  for (const auto& [scope, name] : kQueues) add(VcdGroup::kQueues, scope, name, kCountBits, kUnknown);
}

std::size_t VcdSignals::add(VcdGroup group, std::string scope, std::string name, unsigned bits,
                            std::uint32_t idle) {
  signals_.push_back({group, std::move(scope), std::move(name), bits, idle});
  return signals_.size() - 1;
}

std::size_t VcdSignals::queue(std::string_view name) const {
  const auto* const found =
      std::find_if(kQueues.begin(), kQueues.end(), [name](const auto& queue) { return queue[0] == name; });
  if (found == kQueues.end()) throw std::invalid_argument("queue = " + std::string(name) + ": has no signal");
  return first_level_ + static_cast<std::size_t>(found - kQueues.begin());
}

std::uint32_t VcdSignals::word(std::string_view text) {
  std::string word(text);
  std::replace(word.begin(), word.end(), ' ', '_');
  const auto [entry, is_new] = numbers_.try_emplace(word, static_cast<std::uint32_t>(words_.size()));
  if (is_new) words_.push_back(word);
  return entry->second;
}

}  // namespace stereotlm::trace
