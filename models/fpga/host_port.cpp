#include "models/fpga/host_port.h"

#include <algorithm>
#include <array>

#include "models/memory/memory_config.h"

namespace stereotlm::fpga {
namespace {

bool grants(const memory::BankArbiter::Outcome& outcome) { return outcome.granted != 0; }

}  // namespace

void HostPort::route(const HostRoute& route) {
  burst_ = route;
  is_moved_ = false;
  if (route.bank) {
    read_latency_cycles_ = frames_.read_latency_cycles(*route.bank);
  } else if (is_joined_) {
    is_joined_ = false;
    frames_.host_route_changes();
    arbitration_.unroute(port_);
  }
}

void HostPort::join() {
  if (!burst_.bank || is_joined_) return;
  is_joined_ = true;
  if (ConflictRecorder* const conflicts = frames_.conflicts()) conflicts->set_host_traffic(traffic());
  frames_.host_route_changes();
  arbitration_.route(port_, *burst_.bank, burst_.write);
}

bool HostPort::access(std::uint64_t cycle, std::uint64_t edge_ps) {
  bus_.access(edge_ps, usable_ps(cycle));
  return !bus_.word_waits();
}

std::optional<HostWord> HostPort::next_word() const {
  if (!bus_.word_waits()) return std::nullopt;
  return HostWord{*burst_.bank, words_left().first - memory::crossbar_address(*burst_.bank, 0), traffic()};
}

bool HostPort::is_contended() const { return is_contended(*burst_.bank); }

bool HostPort::is_contended(std::size_t bank) const {
  return frames_.is_running() && (!is_only_master_ || arbitration_.is_used_beside(port_, bank));
}

void HostPort::serve_contended() {
  const std::uint64_t first = clock_.edge_at_or_after(bus_.request_ps());
  move_burst();
  if (is_joined_ || !is_moved_ || !is_in_step_ ||
      frames_.must_step_before(std::max(frames_.cycle(), first) + FastForward::kMostHostCycles)) {
    step_contended(first);
    return;
  }
  const FastForward::Served served =
      frames_.serve_host({*burst_.bank, burst_.write, traffic(), first_word()}, first, bus_.words_left());
  if (served.words != 0)
    bus_.count_granted(served.words, clock_.edge_ps(served.last_cycle), usable_ps(served.last_cycle));
}

// Runs the frame to `first_cycle`, and then steps it.
void HostPort::step_contended(std::uint64_t first_cycle) {
  frames_.run_ahead(first_cycle);  // before join(): the route of the host prevents skipping
  join();
  const std::uint64_t end = frames_.cycle() + FastForward::kMostHostCycles;
  while (frames_.cycle() < end && !frames_.control().frame_done() && bus_.word_waits()) {
    const std::uint64_t cycle = frames_.cycle();
    const std::uint64_t edge_ps = clock_.edge_ps(cycle);
    const bool requests = bus_.requests(edge_ps);
    if (requests) place();
    const memory::PortMask granted = frames_.step(requests);
    if (memory::has(granted, port_)) serve_word(cycle, edge_ps);
  }
}

void HostPort::serve_new_burst() {
  if (is_only_master_ && !is_contended()) serve_uncontended(kNever);
}

std::optional<std::uint64_t> HostPort::serve_uncontended(std::uint64_t horizon_ps) {
  const std::size_t bank = *burst_.bank;
  count_served(UINT64_MAX, true);  // the words of the previous burst, which has ended
  served_bank_ = bank;
  served_traffic_ = traffic();
  // The first cycle that is not decided. A word that was refused up to the end of a frame requests again in
  // this cycle.
  std::uint64_t cycle = frames_.is_running() ? 0 : frames_.cycle();
  move_burst();
  if (is_moved_ && arbitration_.arbiter(bank).grants_at_once() && is_in_step_) serve_in_step(cycle);
  while (bus_.word_waits()) {
    cycle = std::max(cycle, clock_.edge_at_or_after(bus_.request_ps()));
    const std::uint64_t edge_ps = clock_.edge_ps(cycle);
    // Another master of the registers may start a frame that uses the bank: when the finishing frame ends,
    // and at any event from horizon_ps on.
    if (!is_only_master_ && frames_.is_finishing() && cycle >= frames_.done_cycle()) {
      count_words_outside();
      return clock_.edge_ps(frames_.done_cycle());
    }
    if (!is_only_master_ && edge_ps >= horizon_ps) {
      count_words_outside();
      return edge_ps + 1;
    }
    const memory::BankArbiter::Outcome outcome = decide(bank, cycle, burst_.write);
    served_.push_back({cycle, 1, outcome});
    record_served(cycle, 1, grants(outcome), outcome.cause);
    if (grants(outcome)) serve_word(cycle, edge_ps);
    ++cycle;
  }
  if (!frames_.is_running()) count_words_outside();
  return std::nullopt;
}

// The outcome is counted only by count().
memory::BankArbiter::Outcome HostPort::decide(std::size_t bank, std::uint64_t cycle, bool write) {
  memory::BankArbiter& arbiter = arbitration_.arbiter(bank);
  std::array<std::uint32_t, memory::kMostPorts> words;
  if (arbiter.has_rows()) words[port_] = bus_.word_waits() ? first_word() : 0;
  return arbiter.decide(cycle, mask_, write ? mask_ : 0, words.data());
}

// Moves all data of a burst that has just begun, if no frame can start within the burst and its bank grants
// direct access.
void HostPort::move_burst() {
  const std::uint64_t bytes = burst_.end - burst_.first;
  if (is_moved_ || !is_only_master_ || bus_.words_left() * 4 != bytes) return;
  unsigned char* const words = banks_.direct(burst_.first, bytes);
  if (words == nullptr) return;
  bus_.move_words(words);
  if (burst_.write) banks_.changes(burst_.first, bytes);
  banks_.count_direct(*burst_.bank, bytes / 4);
  is_moved_ = true;
}

// The waiting word is granted in `cycle`.
void HostPort::serve_word(std::uint64_t cycle, std::uint64_t edge_ps) {
  if (is_moved_) {
    bus_.count_granted(1, edge_ps, usable_ps(cycle));
  } else {
    banks_.allow_access(port_);
    access(cycle, edge_ps);
  }
}

// Serves one word a cycle from `first_cycle` on, to the end of the burst. The port is uncontended: each grant
// after the first one has the same outcome, and changes the state of the bank's policy as a cycle without
// request does (memory::ArbitrationPolicy).
void HostPort::serve_in_step(std::uint64_t first_cycle) {
  const std::uint64_t first = std::max(first_cycle, bus_.request_clock());
  const std::size_t words = bus_.words_left();
  served_.push_back({first, words, decide(*burst_.bank, first, burst_.write)});
  record_served(first, words, true, 0);
  const std::uint64_t last = first + words - 1;
  bus_.count_granted(words, clock_.edge_ps(last), usable_ps(last));
}

// What the burst is for; without meaning unless conflicts are recorded.
HostTraffic HostPort::traffic() const {
  const ConflictRecorder* const conflicts = frames_.conflicts();
  return conflicts == nullptr ? HostTraffic::kCapture : conflicts->traffic_of(burst_.write, burst_.first);
}

void HostPort::count(const Served& served, bool in_frame) {
  arbitration_.arbiter(served_bank_).count(served.outcome, served.cycles);
  if (in_frame) frames_.control().host_was_busy(grants(served.outcome), served.cycles);
}

void HostPort::count_served(std::uint64_t end_cycle, bool in_frame) {
  ConflictRecorder* const conflicts = in_frame ? frames_.conflicts() : nullptr;
  auto next = served_.begin();
  for (; next != served_.end() && next->cycle < end_cycle; ++next) {
    const std::uint64_t cycles = std::min(next->cycles, end_cycle - next->cycle);
    count({next->cycle, cycles, next->outcome}, in_frame);
    if (conflicts != nullptr) {
      conflicts->add_served(served_traffic_, served_bank_, next->cycle, cycles, grants(next->outcome),
                            next->outcome.cause);
    }
    next->cycle += cycles;
    next->cycles -= cycles;
    if (next->cycles != 0) break;
  }
  if (next == served_.end()) {
    served_.clear();
  } else {
    served_.erase(served_.begin(), next);
  }
}

}  // namespace stereotlm::fpga
