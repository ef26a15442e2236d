#include "models/fpga/host_port.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

void HostPort::route(const HostRoute& route) {
  burst_ = route;
  is_moved_ = false;
  if (route.bank) {
    read_latency_cycles_ = frames_.read_latency_cycles(*route.bank);
  } else {
    leave();
  }
}

void HostPort::join() {
  if (!burst_.bank || is_joined_) return;
  is_joined_ = true;
  if (ConflictRecorder* const conflicts = frames_.conflicts()) conflicts->set_host_traffic(traffic());
  arbitration_.route(port_, *burst_.bank, burst_.write);
}

void HostPort::leave() {
  if (std::exchange(is_joined_, false)) arbitration_.unroute(port_);
}

bool HostPort::access(std::uint64_t cycle, std::uint64_t edge_ps) {
  bus_.access(edge_ps, usable_ps(cycle));
  return !bus_.word_waits();
}

std::optional<HostWord> HostPort::next_word() const {
  if (!bus_.word_waits()) return std::nullopt;
  return HostWord{*burst_.bank, words_left().first - memory::crossbar_address(*burst_.bank, 0), traffic()};
}

bool HostPort::is_contended() const {
  return frames_.is_running() && (!is_only_master_ || arbitration_.is_used_beside(port_, *burst_.bank));
}

void HostPort::serve_contended() {
  move_burst();
  // In step with the core, each word requests in the cycle after a grant.
  const bool is_whole = is_moved_ && is_in_step_ && frames_.cycles() == nullptr;
  const FastForward::Served served =
      frames_.serve_host({*burst_.bank, burst_.write, traffic(), first_word()},
                         clock_.edge_at_or_after(bus_.request_ps()), is_whole ? bus_.words_left() : 1);
  if (served.words != 0) serve_words(served.words, served.last_cycle);
}

void HostPort::serve_new_burst() {
  if (is_only_master_ && !is_contended()) serve_uncontended(kNever);
}

std::optional<std::uint64_t> HostPort::serve_uncontended(std::uint64_t horizon_ps) {
  const std::size_t bank = *burst_.bank;
  count_served(UINT64_MAX, true);  // the words of the previous burst, which has ended
  served_bank_ = bank;
  served_write_ = burst_.write;
  served_traffic_ = traffic();
  served_end_ = burst_.end;
  // The first cycle that is not decided. A word that was refused up to the end of a frame requests again in
  // this cycle.
  std::uint64_t cycle = frames_.is_running() ? 0 : frames_.cycle();
  move_burst();
  const memory::BankArbiter& arbiter = arbitration_.arbiter(bank);
  // A record of cycles takes the words one by one, each with its address.
  const bool is_whole = is_moved_ && !arbiter.has_rows() && (is_in_step_ || frames_.cycles() == nullptr);
  bool has_direction = arbiter.grants_at_once();  // each further word of the burst is granted at once
  while (bus_.word_waits()) {
    if (is_whole && has_direction) {
      serve_at_once(cycle);
      break;
    }
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
    const Served served = decide(bank, cycle, burst_.write);
    served_.push_back(served);
    record_served(cycle, 1, served.granted, served.cause);
    has_direction = served.granted;
    if (has_direction) serve_words(1, cycle);
    ++cycle;
  }
  if (!frames_.is_running()) count_words_outside();
  return std::nullopt;
}

// The outcome is counted only by count().
HostPort::Served HostPort::decide(std::size_t bank, std::uint64_t cycle, bool write) {
  memory::BankArbiter& arbiter = arbitration_.arbiter(bank);
  std::array<std::uint32_t, memory::kMostPorts> words;
  if (arbiter.has_rows()) words[port_] = bus_.word_waits() ? first_word() : 0;
  const memory::BankArbiter::Outcome its = arbiter.decide(cycle, mask_, write ? mask_ : 0, words.data());
  return {cycle, 1, its.granted != 0, static_cast<std::uint32_t>(its.cause)};
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

// These words are granted, the last of them in `last_cycle`. Only words that are moved may be more than one.
void HostPort::serve_words(std::size_t words, std::uint64_t last_cycle) {
  const std::uint64_t edge_ps = clock_.edge_ps(last_cycle);
  if (is_moved_) {
    bus_.count_granted(words, edge_ps, usable_ps(last_cycle));
  } else {
    banks_.allow_access(port_);
    access(last_cycle, edge_ps);
  }
}

// Serves the words from `first_cycle` on, to the end of the burst. The port is uncontended, and its bank is
// ready for its direction: each word is granted in the cycle in which it requests. Each grant after the first
// one has the same outcome, and changes the state of the bank's policy as a cycle without request does
// (memory::ArbitrationPolicy). So only the first and the last word are decided.
void HostPort::serve_at_once(std::uint64_t first_cycle) {
  std::uint64_t cycle = std::max(first_cycle, clock_.edge_at_or_after(bus_.request_ps()));
  const std::size_t words = bus_.words_left();
  served_.push_back(decide(*burst_.bank, cycle, burst_.write));
  if (is_in_step_) {
    served_.back().cycles = words;
    record_served(cycle, words, true, 0);
    cycle += words - 1;
  } else {
    for (std::size_t word = 1; word < words; ++word) {
      cycle = clock_.edge_at_or_after(bus_.next_request_ps(clock_.edge_ps(cycle)));
      served_.push_back({cycle, 1, true, 0});
    }
  }
  // An access in the other direction waits from the last word on.
  if (words > 1) decide(*burst_.bank, cycle, burst_.write);
  serve_words(words, cycle);
}

// What the burst is for; without meaning unless conflicts are recorded.
HostTraffic HostPort::traffic() const {
  const ConflictRecorder* const conflicts = frames_.conflicts();
  return conflicts == nullptr ? HostTraffic::kCapture : conflicts->traffic_of(burst_.write, burst_.first);
}

void HostPort::count(const Served& served, std::uint64_t cycles, bool in_frame) {
  const memory::BankArbiter::Outcome outcome = {mask_, served_write_ ? mask_ : 0, served.granted ? mask_ : 0,
                                                served.cause};
  arbitration_.arbiter(served_bank_).count(outcome, cycles);
  if (in_frame) frames_.control().count_host(served.granted, cycles);
}

void HostPort::count_served(std::uint64_t end_cycle, bool in_frame) {
  ConflictRecorder* const conflicts = in_frame ? frames_.conflicts() : nullptr;
  const auto are_alike = [](const Served& a, const Served& b) {
    return a.granted == b.granted && (a.granted || a.cause == b.cause);
  };
  std::uint64_t alike = 0;  // cycles in a row with the outcome of `next`, which are counted together
  auto next = served_.begin();
  for (; next != served_.end() && next->cycle < end_cycle; ++next) {
    const std::uint64_t cycles = std::min(next->cycles, end_cycle - next->cycle);
    alike += cycles;
    const auto after = std::next(next);
    if (after == served_.end() || after->cycle >= end_cycle || !are_alike(*after, *next))
      count(*next, std::exchange(alike, 0), in_frame);
    if (conflicts != nullptr) {
      conflicts->hear_apart(served_traffic_, served_bank_, next->cycle, cycles, next->granted, next->cause);
    }
    if (cycles == next->cycles) continue;
    next->cycle += cycles;
    next->cycles -= cycles;
    break;
  }
  if (!in_frame) counted_ahead_.swap(served_);
  if (!in_frame || next == served_.end()) {
    served_.clear();
  } else {
    served_.erase(served_.begin(), next);
  }
}

AddressRange HostPort::counted_ahead_of(std::uint64_t cycle) const {
  std::uint64_t words = 0;
  for (const Served& served : counted_ahead_) {
    if (served.granted && served.cycle + served.cycles > cycle)
      words += std::min(served.cycles, served.cycle + served.cycles - cycle);
  }
  return {served_end_ - 4 * words, served_end_};
}

}  // namespace stereotlm::fpga
