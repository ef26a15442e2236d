#include "models/pci/pci_bus.h"

#include <algorithm>
#include <utility>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {
namespace {

constexpr char kReport[] = "/stereotlm/pci_bus";
constexpr std::size_t kNobody = SIZE_MAX;
constexpr std::uint64_t kDevselClocks = 4;  // clocks for which a master waits for DEVSEL#

BurstEnd end_of(std::size_t words, std::size_t accepted, std::size_t asked) {
  if (words == asked) return BurstEnd::kComplete;
  return words == accepted ? BurstEnd::kDisconnect : BurstEnd::kLatencyTimer;
}

}  // namespace

PciBus::PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config)
    : sc_module(name),
      slots("slot", config.masters.size()),
      targets("target", config.windows.size()),
      stops("stop", config.windows.size()),
      config_(checked(this->name(), config)),
      clock_(config.clock_mhz),
      requests_(config.masters.size()),
      last_granted_(config.masters.size() - 1),
      memories_(config.windows.size()) {
  kernel_time::check_resolution();
  SC_HAS_PROCESS(PciBus);
  for (std::size_t master = 0; master < slots.size(); ++master) {
    slots[master].bind(slots_.emplace_back(*this, master));
    master_stats_.emplace_back().name = config.masters[master];
  }
  for (auto& target : targets) target.register_invalidate_direct_mem_ptr(this, &PciBus::forget_memories);
  SC_METHOD(step);
  sensitive << step_;
  dont_initialize();
  SC_THREAD(run_transports);
}

void PciBus::request(std::size_t master, PciMasterIf& from, std::uint64_t from_ps) {
  if (requests_[master].clock != kNever) return;
  requests_[master] = {&from, clock_.edge_at_or_after(from_ps)};
  if (state_ == State::kFree) {
    await_request();
  } else if (state_ == State::kWords && master != running_.master) {
    cut_words();
  }
}

void PciBus::await_request() {
  const std::uint64_t earliest = earliest_request(kNobody);
  if (earliest == kNever) return;
  const std::uint64_t clock = std::max(free_clock_, earliest);
  if (clock >= decision_clock_) return;
  decision_clock_ = clock;
  step_at(clock_.edge_ps(clock));
}

std::uint64_t PciBus::earliest_request(std::size_t except) const {
  std::uint64_t earliest = kNever;
  for (std::size_t master = 0; master < requests_.size(); ++master) {
    if (master != except) earliest = std::min(earliest, requests_[master].clock);
  }
  return earliest;
}

void PciBus::step() {
  switch (state_) {
    case State::kFree:
      arbitration_.request();
      break;
    case State::kWords:
      end_words();
      break;
    case State::kEnding:
      end();
      break;
    case State::kOccupied:
      break;
  }
}

// Grants decision_clock_ to the requests in turn until one of them is used.
void PciBus::arbitrate() {
  const std::uint64_t clock = decision_clock_;
  const std::uint64_t edge_ps = clock_.edge_ps(clock);
  decision_clock_ = kNever;
  free_clock_ = clock + 1;  // in case that no request is used
  state_ = State::kOccupied;
  std::size_t master = last_granted_;
  for (std::size_t tried = 0; tried < requests_.size(); ++tried) {
    master = master + 1 < requests_.size() ? master + 1 : 0;
    Request& request = requests_[master];
    if (request.clock > clock) continue;
    const std::uint64_t request_clock = std::exchange(request.clock, kNever);
    last_granted_ = master;
    const PciBurst burst = request.from->begin_burst(edge_ps);
    if (burst.words == nullptr || burst.words->empty()) continue;
    master_stats_[master].wait_clocks += clock - request_clock;
    address_clock_ = clock;
    begin(master, burst);
    return;
  }
  state_ = State::kFree;
  await_request();
}

void PciBus::begin(std::size_t master, const PciBurst& burst) {
  const std::uint64_t address_clock = *address_clock_;
  const auto window = window_of(burst);
  running_ = {master, burst, window.value_or(0), burst.words->size(), address_clock, 0, false, {}};
  if (!window) {
    const std::uint64_t end_clock = address_clock + 1 + kDevselClocks;
    end_at(end_clock, {BurstEnd::kMasterAbort, 0, end_clock});
  } else if (!burst.write) {
    read_words_.assign(burst.words->size(), 0);
    access(read_words_, running_.accepted);
  } else if (running_.accepted = writable_words(); running_.accepted == 0) {
    end_at(address_clock + 1, {BurstEnd::kDisconnect, 0, address_clock + 1});
  } else {
    begin_words(address_clock + 1 + static_cast<std::uint64_t>(config_.windows[*window].wait_clocks),
                running_.accepted);
  }
}

void PciBus::begin_words(std::uint64_t first_clock, std::size_t words) {
  running_.result.first_data_clock = first_clock;
  running_.end_clock = first_clock + words;
  running_.transported = running_.burst.write && !memories_.has(running_.window);
  state_ = State::kWords;
  end_words_at(running_.end_clock);
  cut_words();
}

// Cuts the burst for the earliest request of another master. A later request would not cut it earlier.
void PciBus::cut_words() {
  const std::uint64_t request = earliest_request(running_.master);
  if (request == kNever) return;
  const std::uint64_t last_word =
      std::max({running_.address_clock + static_cast<std::uint64_t>(config_.latency_timer_clocks), request,
                running_.result.first_data_clock});
  if (last_word + 1 < running_.end_clock) end_words_at(last_word + 1);
}

void PciBus::end_words_at(std::uint64_t clock) {
  running_.end_clock = clock;
  (running_.transported ? transport_ : step_)
      .notify(kernel_time::to_time(clock_.edge_ps(clock) - kernel_time::now_ps()));
}

void PciBus::end_words() {
  state_ = State::kOccupied;
  const std::uint64_t first = running_.result.first_data_clock;
  const auto words = static_cast<std::size_t>(running_.end_clock - first);
  std::vector<std::uint32_t>& to = *running_.burst.words;
  running_.result = {end_of(words, running_.accepted, to.size()), words, first};
  if (running_.burst.write) {
    access(to, words);
  } else {
    std::copy_n(read_words_.begin(), words, to.begin());
    end();
  }
}

void PciBus::end_at(std::uint64_t clock, const BurstResult& result) {
  running_.result = result;
  running_.end_clock = clock;
  state_ = State::kEnding;
  step_at(clock_.edge_ps(clock));
}

void PciBus::end() {
  state_ = State::kOccupied;
  address_clock_.reset();
  busy_clocks_ += running_.end_clock - running_.address_clock;
  count(running_.master, running_.result);
  free_clock_ = running_.end_clock + 1;
  running_.result.end_ps = kernel_time::now_ps();
  requests_[running_.master].from->end_burst(running_.result);
  state_ = State::kFree;
  await_request();
}

// Makes the access of the running burst: of a write when its words have been transferred, of a read at the
// end of the address clock.
void PciBus::access(std::vector<std::uint32_t>& words, std::size_t count) {
  const bool write = running_.burst.write;
  access_.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  access_.set_address(running_.burst.address - config_.windows[running_.window].base);
  access_.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  access_.set_data_length(static_cast<unsigned>(count * sizeof(std::uint32_t)));
  if (memories_.access(running_.window, access_)) {
    end_access(true, access_clock());
  } else {
    transport_is_due_ = true;
    transport_.notify();
  }
}

std::uint64_t PciBus::access_clock() const {
  return running_.burst.write ? running_.end_clock : running_.address_clock + 1;
}

// b_transport may wait, and is therefore called in a thread. A write that ends in this thread costs no
// further event.
void PciBus::run_transports() {
  for (;;) {
    wait(transport_);
    if (state_ == State::kWords) end_words();
    if (std::exchange(transport_is_due_, false)) transport();
  }
}

void PciBus::transport() {
  access_.set_streaming_width(access_.get_data_length());
  access_.set_byte_enable_ptr(nullptr);
  access_.set_byte_enable_length(0);
  access_.set_dmi_allowed(false);
  access_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  const std::uint64_t access_ps = clock_.edge_ps(access_clock());
  sc_core::sc_time delay = kernel_time::to_time(access_ps - kernel_time::now_ps());
  targets[running_.window]->b_transport(access_, delay);
  if (access_.is_dmi_allowed())
    memories_.request(running_.window, *targets[running_.window].operator->(), access_);
  const std::uint64_t answer_ps = kernel_time::now_ps() + kernel_time::to_ps(delay);
  end_access(access_.is_response_ok(),
             answer_ps == access_ps ? access_clock() : clock_.edge_at_or_after(answer_ps));
}

// The target has responded. `clock`: the first clock that begins at or after the response.
void PciBus::end_access(bool ok, std::uint64_t clock) {
  BurstResult result = running_.result;
  if (running_.burst.write) {
    if (!ok) result = {BurstEnd::kTargetError, 0, result.first_data_clock};
    if (clock > running_.end_clock) return end_at(clock, result);
    running_.result = result;
    end();
    return;
  }
  const std::uint64_t first = std::max(
      running_.address_clock + 1 + static_cast<std::uint64_t>(config_.windows[running_.window].wait_clocks),
      clock);
  if (ok) {
    begin_words(first, running_.accepted);
  } else {
    end_at(first + 1, {BurstEnd::kTargetError, 0, first});
  }
}

std::size_t PciBus::writable_words() const {
  const std::size_t asked = running_.burst.words->size();
  const PciStopPort& stop = stops[running_.window];
  if (stop.size() == 0) return asked;
  const std::uint64_t address = running_.burst.address - config_.windows[running_.window].base;
  const std::size_t taken = stop->writable_words(address, asked);
  if (taken <= asked) return taken;
  SC_REPORT_ERROR(kReport, (std::string(stop.name()) + ": " + std::to_string(taken) + " of " +
                            std::to_string(asked) + " words can be written")
                               .c_str());
  return asked;
}

void PciBus::count(std::size_t master, const BurstResult& result) {
  MasterStats& stats = master_stats_[master];
  ++stats.transactions;
  stats.words += result.words;
  if (result.end == BurstEnd::kDisconnect && result.words == 0) ++stats.retries;
  if (is_error(result.end)) ++stats.aborts;
}

// Outside the data clocks, running_.result has the number of words.
BurstResult PciBus::transferred(std::size_t master, std::uint64_t now_ps) const {
  if (!address_clock_ || running_.master != master) return {};
  BurstResult so_far = running_.result;
  if (state_ == State::kWords && whole_clocks(now_ps) > so_far.first_data_clock)
    so_far.words = static_cast<std::size_t>(whole_clocks(now_ps) - so_far.first_data_clock);
  return so_far;
}

std::uint64_t PciBus::whole_clocks(std::uint64_t now_ps) const {
  return clock_.edge_at_or_after(now_ps + 1) - 1;
}

PciBus::Stats PciBus::stats() const {
  Stats stats;
  stats.clocks = whole_clocks(kernel_time::now_ps());
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

void PciBus::step_at(std::uint64_t time_ps) {
  step_.notify(kernel_time::to_time(time_ps - kernel_time::now_ps()));
}

}  // namespace stereotlm::pci
