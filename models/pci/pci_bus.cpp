#include "models/pci/pci_bus.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::pci {
namespace {

constexpr char kReport[] = "/stereotlm/pci_bus";
constexpr std::uint64_t kDevselClocks = 4;  // that a master waits for DEVSEL# after its address clock

const PciBusConfig& checked(const char* name, const PciBusConfig& config) {
  if (const auto found = problems(config); !found.empty()) {
    throw std::invalid_argument(std::string(name) + ": " + found.front());
  }
  return config;
}

std::uint64_t now_ps() { return Clock::to_ps(sc_core::sc_time_stamp()); }

BurstEnd end_of(std::size_t words, std::size_t taken, std::size_t asked) {
  if (words == asked) return BurstEnd::kComplete;
  return words == taken ? BurstEnd::kDisconnect : BurstEnd::kLatencyTimer;
}

}  // namespace

PciBus::PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config)
    : sc_module(name),
      slots("slot", config.masters.size()),
      targets("target", config.windows.size()),
      stops("stop", config.windows.size()),
      config_(checked(this->name(), config)),
      clock_(config.clock_mhz),
      last_granted_(config.masters.size() - 1) {
  SC_HAS_PROCESS(PciBus);
  for (std::size_t master = 0; master < slots.size(); ++master) {
    slots[master].bind(slots_.emplace_back(*this));
    master_stats_.emplace_back().name = config.masters[master];
  }
  SC_THREAD(run);
}

void PciBus::Slot::request(PciMasterIf& from) {
  if (request_ps != kNever) return;
  master = &from;
  request_ps = now_ps();
  bus_.requested_.notify(sc_core::SC_ZERO_TIME);
}

void PciBus::run() {
  std::uint64_t clock = 0;  // the first that can be an address clock
  for (;;) {
    while (earliest_request_ps() == kNever) wait(requested_);
    clock = std::max(clock, clock_.edge_at_or_after(earliest_request_ps()));
    wait_until(clock_.edge_ps(clock) + 1);
    clock = arbitrate(clock);
  }
}

// Grants the clock to its requests in turn until one is used. Returns the clock after that burst's idle
// clock; the same clock if none is used.
std::uint64_t PciBus::arbitrate(std::uint64_t clock) {
  const std::uint64_t edge_ps = clock_.edge_ps(clock);
  const std::size_t first = last_granted_ + 1;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const std::size_t master = (first + i) % slots_.size();
    Slot& slot = slots_[master];
    if (slot.request_ps > edge_ps) continue;
    const std::uint64_t request_clock = clock_.edge_at_or_after(slot.request_ps);
    slot.request_ps = kNever;
    last_granted_ = master;
    const PciBurst burst = slot.master->begin_burst(edge_ps);
    if (burst.words == nullptr || burst.words->empty()) continue;
    master_stats_[master].wait_clocks += clock - request_clock;
    address_clock_ = clock;
    const Outcome outcome = carry_out({master, burst, clock});
    address_clock_.reset();
    busy_clocks_ += outcome.end_clock - clock;
    count(master, outcome.result);
    slot.master->end_burst(outcome.result);
    return outcome.end_clock + 1;
  }
  return clock;
}

// Waits for the end of the burst.
PciBus::Outcome PciBus::carry_out(const Running& running) {
  const auto window = window_of(running.burst);
  if (window) return running.burst.write ? write(running, *window) : read(running, *window);
  const std::uint64_t end = running.address_clock + 1 + kDevselClocks;
  wait_until(clock_.edge_ps(end));
  return {{BurstEnd::kMasterAbort, 0, end}, end};
}

PciBus::Outcome PciBus::write(const Running& running, std::size_t window) {
  const std::size_t taken = writable_words(running, window);
  if (taken == 0) {
    const std::uint64_t end = running.address_clock + 1;
    wait_until(clock_.edge_ps(end));
    return {{BurstEnd::kDisconnect, 0, end}, end};
  }
  const std::uint64_t first =
      running.address_clock + 1 + static_cast<std::uint64_t>(config_.windows[window].wait_clocks);
  std::uint64_t end = transfer_words(running, first, taken);
  const auto words = static_cast<std::size_t>(end - first);
  sc_core::sc_time delay;
  const bool ok = transport(tlm::TLM_WRITE_COMMAND, running, window, *running.burst.words, words, delay);
  end = std::max(end, clock_.edge_at_or_after(now_ps() + Clock::to_ps(delay)));
  wait_until(clock_.edge_ps(end));
  if (!ok) return {{BurstEnd::kTargetError, 0, first}, end};
  return {{end_of(words, taken, running.burst.words->size()), words, first}, end};
}

PciBus::Outcome PciBus::read(const Running& running, std::size_t window) {
  const std::size_t asked = running.burst.words->size();
  const std::uint64_t data_clock = running.address_clock + 1;
  read_words_.assign(asked, 0);
  sc_core::sc_time delay = Clock::to_time(clock_.edge_ps(data_clock) - now_ps());
  const bool ok = transport(tlm::TLM_READ_COMMAND, running, window, read_words_, asked, delay);
  const std::uint64_t first =
      std::max(data_clock + static_cast<std::uint64_t>(config_.windows[window].wait_clocks),
               clock_.edge_at_or_after(now_ps() + Clock::to_ps(delay)));
  if (!ok) {
    wait_until(clock_.edge_ps(first + 1));
    return {{BurstEnd::kTargetError, 0, first}, first + 1};
  }
  const std::uint64_t end = transfer_words(running, first, asked);
  const auto words = static_cast<std::size_t>(end - first);
  std::copy_n(read_words_.begin(), words, running.burst.words->begin());
  return {{end_of(words, asked, asked), words, first}, end};
}

std::size_t PciBus::writable_words(const Running& running, std::size_t window) {
  const std::size_t asked = running.burst.words->size();
  if (stops[window].size() == 0) return asked;
  const std::size_t taken = stops[window]->writable_words(offset(running.burst, window), asked);
  if (taken <= asked) return taken;
  SC_REPORT_ERROR(kReport, (std::string(stops[window].name()) + ": " + std::to_string(taken) + " of " +
                            std::to_string(asked) + " words can be written")
                               .c_str());
  return asked;
}

// Only the earliest request of the others matters: a later one cuts no earlier.
std::uint64_t PciBus::transfer_words(const Running& running, std::uint64_t first_data_clock,
                                     std::size_t words) {
  const std::uint64_t end = first_data_clock + words;
  const std::uint64_t end_ps = clock_.edge_ps(end);
  const Slot& owner = slots_[running.master];
  while (earliest_request_ps(&owner) == kNever) {
    if (now_ps() >= end_ps) return end;
    wait(Clock::to_time(end_ps - now_ps()), requested_);
  }
  const std::uint64_t last_word =
      std::max({running.address_clock + static_cast<std::uint64_t>(config_.latency_timer_clocks),
                clock_.edge_at_or_after(earliest_request_ps(&owner)), first_data_clock});
  const std::uint64_t cut = std::min(end, last_word + 1);
  wait_until(clock_.edge_ps(cut));
  return cut;
}

bool PciBus::transport(tlm::tlm_command command, const Running& running, std::size_t window,
                       std::vector<std::uint32_t>& words, std::size_t count, sc_core::sc_time& delay) {
  const auto bytes = static_cast<unsigned>(count * sizeof(std::uint32_t));
  access_.set_command(command);
  access_.set_address(offset(running.burst, window));
  access_.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  access_.set_data_length(bytes);
  access_.set_streaming_width(bytes);
  access_.set_byte_enable_ptr(nullptr);
  access_.set_byte_enable_length(0);
  access_.set_dmi_allowed(false);
  access_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  targets[window]->b_transport(access_, delay);
  return access_.is_response_ok();
}

void PciBus::count(std::size_t master, const BurstResult& result) {
  MasterStats& stats = master_stats_[master];
  ++stats.transactions;
  stats.words += result.words;
  if (result.end == BurstEnd::kDisconnect && result.words == 0) ++stats.retries;
  if (result.end == BurstEnd::kMasterAbort || result.end == BurstEnd::kTargetError) ++stats.aborts;
}

PciBus::Stats PciBus::stats() const {
  Stats stats;
  stats.clocks = clock_.edge_at_or_after(now_ps() + 1) - 1;
  stats.busy_clocks = busy_clocks_ + (address_clock_ ? stats.clocks - *address_clock_ : 0);
  stats.masters = master_stats_;
  return stats;
}

std::optional<std::size_t> PciBus::window_of(const PciBurst& burst) const {
  if (burst.address % 4 != 0) {
    SC_REPORT_ERROR(kReport,
                    ("address = " + std::to_string(burst.address) + ": must be a multiple of 4").c_str());
    return std::nullopt;
  }
  for (std::size_t i = 0; i < config_.windows.size(); ++i) {
    const PciWindow& window = config_.windows[i];
    if (burst.address < window.base || burst.address - window.base >= window.bytes) continue;
    if (burst.words->size() <= (window.bytes - (burst.address - window.base)) / 4) return i;
  }
  return std::nullopt;
}

std::uint64_t PciBus::earliest_request_ps(const Slot* except) const {
  std::uint64_t earliest = kNever;
  for (const Slot& slot : slots_) {
    if (&slot != except) earliest = std::min(earliest, slot.request_ps);
  }
  return earliest;
}

void PciBus::wait_until(std::uint64_t time_ps) {
  if (const std::uint64_t now = now_ps(); time_ps > now) wait(Clock::to_time(time_ps - now));
}

}  // namespace stereotlm::pci
