#include "models/pci/pci_bus_control.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::pci {
namespace {

constexpr std::uint64_t kDevselClocks = 4;  // clocks for which a master waits for DEVSEL#
constexpr std::size_t kNoMaster = SIZE_MAX;

BurstEnd end_of(std::size_t words, std::size_t accepted, std::size_t asked) {
  if (words == asked) return BurstEnd::kComplete;
  return words == accepted ? BurstEnd::kDisconnect : BurstEnd::kLatencyTimer;
}

}  // namespace

PciBusControl::PciBusControl(const PciBusConfig& config)
    : clock_(config.clock_mhz),
      latency_timer_clocks_(static_cast<std::uint64_t>(config.latency_timer_clocks)),
      words_per_clock_(static_cast<std::size_t>(config.width_bits) / 32),
      requests_(config.masters.size()),
      last_granted_(config.masters.size() - 1) {
  for (const PciWindow& window : config.windows) windows_.push_back({window});
  for (const std::string& master : config.masters) {
    slots_.emplace_back(*this, slots_.size());
    master_stats_.emplace_back().name = master;
  }
}

void PciBusControl::request(std::size_t master, PciMasterIf& from, std::uint64_t from_ps) {
  if (requests_[master].clock != kNever) return;
  // A master often requests again as its burst ends.
  requests_[master] = {&from, from_ps == last_ps_ ? free_clock_ - 1 : clock_.edge_at_or_after(from_ps)};
  if (state_ == State::kFree) {
    await_request();
  } else if (state_ == State::kWords && master != running_.master) {
    cut_words();
  }
}

void PciBusControl::await_request() {
  const std::uint64_t earliest = earliest_request(kNoMaster);
  if (earliest == kNever) return;
  const std::uint64_t clock = std::max(free_clock_, earliest);
  if (clock >= decision_clock_) return;
  decision_clock_ = clock;
  next_ps_ = clock_.edge_ps(clock);
}

std::uint64_t PciBusControl::earliest_request(std::size_t without) const {
  std::uint64_t earliest = kNever;
  for (std::size_t master = 0; master < requests_.size(); ++master)
    if (master != without) earliest = std::min(earliest, requests_[master].clock);
  return earliest;
}

void PciBusControl::step(std::uint64_t now_ps) {
  next_ps_ = kNever;
  if (state_ == State::kWords) {
    end_words(now_ps);
  } else {
    end(now_ps);
  }
}

// Grants decision_clock_ to the requests in turn until one of them is used.
void PciBusControl::decide(std::uint64_t now_ps) {
  const std::uint64_t clock = std::exchange(decision_clock_, kNever);
  next_ps_ = kNever;
  free_clock_ = clock + 1;  // in case that no request is used
  last_ps_ = now_ps;
  state_ = State::kOccupied;
  std::size_t master = last_granted_;
  for (std::size_t tried = 0; tried < requests_.size(); ++tried) {
    master = master + 1 < requests_.size() ? master + 1 : 0;
    Request& request = requests_[master];
    if (request.clock > clock) continue;
    const std::uint64_t request_clock = std::exchange(request.clock, kNever);
    last_granted_ = master;
    const PciBurst burst = request.from->begin_burst(now_ps);
    if (burst.words == nullptr || burst.words->empty()) continue;
    if (burst.address % 4 != 0)
      throw std::logic_error("address = " + std::to_string(burst.address) + ": must be a multiple of 4");
    master_stats_[master].wait_clocks += clock - request_clock;
    begin(now_ps, master, burst, request_clock, clock);
    return;
  }
  state_ = State::kFree;
  await_request();
}

void PciBusControl::begin(std::uint64_t now_ps, std::size_t master, const PciBurst& burst,
                          std::uint64_t request_clock, std::uint64_t clock) {
  burst_runs_ = true;
  running_ = {master, burst, window_of(burst), burst.words->size(), request_clock, clock, 0, {}};
  if (running_.window == nullptr) {
    const std::uint64_t end_clock = clock + 1 + kDevselClocks;
    end_at(end_clock, {BurstEnd::kMasterAbort, 0, end_clock});
    return;
  }
  if (!burst.write) {
    read_words_.assign(burst.words->size(), 0);
    access(now_ps, read_words_, running_.accepted);
    return;
  }
  const std::uint64_t address = burst.address - running_.window->config.base;
  running_.accepted = running_.window->target->writable_words(now_ps, address, burst.words->size());
  if (running_.accepted == 0) {
    end_at(clock + 1, {BurstEnd::kDisconnect, 0, clock + 1});
  } else {
    begin_words(clock + 1 + static_cast<std::uint64_t>(running_.window->config.wait_clocks));
  }
}

void PciBusControl::begin_words(std::uint64_t first_clock) {
  running_.result.first_data_clock = first_clock;
  running_.result.words_per_clock = words_per_clock_;
  state_ = State::kWords;
  end_words_at(first_clock + (words_per_clock_ == 2 ? (running_.accepted + 1) / 2 : running_.accepted));
  cut_words();
}

// Cuts the burst for the earliest request of another master. A later request would not cut it earlier.
void PciBusControl::cut_words() {
  const std::uint64_t request = earliest_request(running_.master);
  if (request == kNever) return;
  const std::uint64_t last_data_clock =
      std::max({running_.address_clock + latency_timer_clocks_, request, running_.result.first_data_clock});
  if (last_data_clock + 1 < running_.end_clock) end_words_at(last_data_clock + 1);
}

void PciBusControl::end_words_at(std::uint64_t clock) {
  running_.end_clock = clock;
  next_ps_ = clock_.edge_ps(clock);
}

bool PciBusControl::writes_next() const { return state_ == State::kWords && running_.burst.write; }

void PciBusControl::end_words(std::uint64_t now_ps) {
  state_ = State::kOccupied;
  std::vector<std::uint32_t>& to = *running_.burst.words;
  running_.result.words = running_.accepted;
  const std::size_t words = running_.result.words_before(running_.end_clock);
  running_.result.words = words;
  running_.result.end = end_of(words, running_.accepted, to.size());
  if (running_.burst.write) {
    access(now_ps, to, words);
  } else {
    std::copy_n(read_words_.begin(), words, to.begin());
    end(now_ps);
  }
}

void PciBusControl::end_at(std::uint64_t clock, const BurstResult& result) {
  running_.result = result;
  running_.end_clock = clock;
  state_ = State::kEnding;
  next_ps_ = clock_.edge_ps(clock);
}

void PciBusControl::end(std::uint64_t now_ps) {
  state_ = State::kOccupied;
  burst_runs_ = false;
  busy_clocks_ += running_.end_clock - running_.address_clock;
  count(running_.master, running_.result);
  free_clock_ = running_.end_clock + 1;
  last_ps_ = now_ps;
  running_.result.end_ps = now_ps;
  if (observer_ != nullptr) report();
  requests_[running_.master].from->end_burst(running_.result);
  state_ = State::kFree;
  await_request();
}

void PciBusControl::report() const {
  std::optional<std::size_t> window;
  if (running_.window != nullptr) window = static_cast<std::size_t>(running_.window - windows_.data());
  observer_->pci_burst_ended(
      {running_.master, window, running_.burst.write, running_.burst.address, running_.result.words,
       clock_.edge_ps(running_.request_clock), clock_.edge_ps(running_.address_clock),
       clock_.edge_ps(running_.address_clock + 1), clock_.edge_ps(running_.end_clock)});
}

// Makes the access of the running burst: of a write when its words have been transferred, of a read at the
// end of the address clock.
void PciBusControl::access(std::uint64_t now_ps, std::vector<std::uint32_t>& words, std::size_t count) {
  const bool write = running_.burst.write;
  const std::uint64_t at_ps = write ? now_ps : clock_.edge_ps(access_clock());
  const PciAnswer given = running_.window->target->access(
      now_ps, {write, running_.burst.address - running_.window->config.base, words.data(), count}, at_ps);
  if (given.time_ps == at_ps) {
    end_access(now_ps, given.ok, access_clock());
  } else if (given.time_ps != kNever) {
    answer(now_ps, given);
  }
}

std::uint64_t PciBusControl::access_clock() const {
  return running_.burst.write ? running_.end_clock : running_.address_clock + 1;
}

void PciBusControl::answer(std::uint64_t now_ps, const PciAnswer& answer) {
  end_access(now_ps, answer.ok, clock_.edge_at_or_after(answer.time_ps));
}

// The target has responded. `clock`: the first clock that begins at or after the response.
void PciBusControl::end_access(std::uint64_t now_ps, bool ok, std::uint64_t clock) {
  BurstResult result = running_.result;
  if (running_.burst.write) {
    if (!ok) result = {BurstEnd::kTargetError, 0, result.first_data_clock};
    if (clock > running_.end_clock) return end_at(clock, result);
    running_.result = result;
    end(now_ps);
    return;
  }
  const std::uint64_t first = std::max(
      running_.address_clock + 1 + static_cast<std::uint64_t>(running_.window->config.wait_clocks), clock);
  if (ok) {
    begin_words(first);
  } else {
    end_at(first + 1, {BurstEnd::kTargetError, 0, first});
  }
}

void PciBusControl::count(std::size_t master, const BurstResult& result) {
  MasterStats& stats = master_stats_[master];
  ++stats.transactions;
  stats.words += result.words;
  if (result.end == BurstEnd::kDisconnect && result.words == 0) ++stats.retries;
  if (is_error(result.end)) ++stats.aborts;
}

// Outside the data clocks, running_.result has the number of words.
BurstResult PciBusControl::transferred(std::size_t master, std::uint64_t now_ps) const {
  if (!burst_runs_ || running_.master != master) return {};
  BurstResult so_far = running_.result;
  if (state_ == State::kWords) {
    so_far.words = running_.accepted;
    so_far.words = so_far.words_before(whole_clocks(now_ps));
  }
  return so_far;
}

PciBusControl::Stats PciBusControl::stats(std::uint64_t now_ps) const {
  Stats stats;
  stats.clocks = whole_clocks(now_ps);
  stats.busy_clocks = busy_clocks_ + (burst_runs_ ? stats.clocks - running_.address_clock : 0);
  stats.masters = master_stats_;
  return stats;
}

// Null if no window holds the burst.
PciBusControl::Window* PciBusControl::window_of(const PciBurst& burst) {
  for (Window& window : windows_) {
    const std::uint64_t offset = burst.address - window.config.base;  // huge below the window
    if (offset < window.config.bytes && burst.words->size() <= (window.config.bytes - offset) / 4)
      return &window;
  }
  return nullptr;
}

}  // namespace stereotlm::pci
