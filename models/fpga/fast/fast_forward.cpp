#include "models/fpga/fast/fast_forward.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::fpga {
namespace {

// After this number of groups with the same accesses, the walk expects more groups with these accesses.
constexpr int kManyAlike = 8;

// The empty slots of a column of a strip: bit k for slot k.
std::uint64_t empty_slots(const FrameGeometry& geometry, int strip) {
  std::uint64_t empty = 0;
  for (int k = 0; k < geometry.slots_per_column; ++k) {
    const int row = geometry.first_row_of(strip) + k;
    empty |= std::uint64_t{!geometry.is_inside(row)} << k;
  }
  return empty;
}

static_assert(memory::kBankCountRule.max <= 1 << 6U &&
              2 * memory::kBankCountRule.max - 1 <= HostRequests::kMostRoute);

}  // namespace

FastForward::FastForward(const CoreConfig& config, memory::Arbitration& arbitration)
    : CoreStepper(config, arbitration),
      lane_fifo_slots_(static_cast<std::uint64_t>(config.lane_fifo_slots)),
      known_(static_cast<std::size_t>(4 * control().geometry().slots_per_column + config.lane_fifo_slots)) {
  const FrameGeometry& geometry = control().geometry();
  for (int strip = 0; strip < geometry.strips; ++strip) {
    const std::uint64_t empty = empty_slots(geometry, strip);
    if (all_strips_.empty() || all_strips_.back().empty != empty) all_strips_.push_back({0, empty});
    all_strips_.back().end = (static_cast<std::uint64_t>(strip) + 1) * geometry.columns_per_strip() *
                             static_cast<std::uint64_t>(geometry.slots_per_column);
  }
}

void FastForward::start_direct_frame(const AccessPatterns& patterns, const FrameBases& bases) {
  start_stepped_frame();
  banks_ = 0;
  for (const std::uint32_t base : bases) banks_ = banks_ << 6U | registers::bank_of(base);
  strips_ = 0;
  for (const Side side : kSides) {
    const AccessPattern* const pattern = &patterns[index_of(side)];
    if (!control().lane(side).has_table() || pattern->needs_all_pixels()) continue;
    const bool is_assumed = arbitration().is_alone(pixel_port(side));
    (is_assumed ? assumed_ : varying_)[index_of(side)] = pattern;
  }
  tell_assumed();
}

void FastForward::start_stepped_frame() {
  if (ahead_.cycles != 0) throw std::logic_error("a frame starts before the last one was settled");
  stepped_.reset();
  is_walking_ = false;
  varying_ = {};
  assumed_ = {};
}

void FastForward::settle(std::uint64_t cycle) {
  stepped_.reset();
  leave_walk(cycle);
  for (const Side side : kSides) resolve_accesses(side);
  if (is_host_routed_) arbitration().unroute(kHostPort);
  is_host_routed_ = false;
}

// LaneControl::correct_marks() of a side.
std::uint64_t FastForward::marks(Side side) const {
  const LaneControl& lane = control().lane(side);
  if (!lane.has_table() || lane.handled() == lane.taken()) return 0;
  std::uint64_t marks = 0;
  SlotCursor slot(control().geometry());
  slot.advance(lane.handled());
  for (std::uint64_t mark = 1, left = lane.taken() - lane.handled(); left > 0; --left, mark <<= 1U) {
    if (!slot.empty() && accesses_pixel(side, slot)) marks |= mark;
    slot.advance();
  }
  return marks;
}

// To be called before the pixel port of a side ceases to be alone on its bank, and after the last cycle of a
// frame. Corrects the counts. From now on the pattern determines which slots need their pixels.
void FastForward::resolve_accesses(Side side) {
  const AccessPattern* const pattern = std::exchange(assumed_[index_of(side)], nullptr);
  if (pattern == nullptr) return;
  varying_[index_of(side)] = pattern;
  const std::uint64_t passed = pattern->passes_before(control().lane(side).handled());
  control().correct_passes(side, passed);
  control().correct_marks(side, marks(side));
  arbitration().retract_grants(pixel_port(side), passed);
  tell_assumed();
}

// `kMayRequest`: false if the host does not request, as in most cycles. That costs less.
template <bool kMayRequest>
memory::PortMask FastForward::step_core(std::uint64_t cycle, bool host_requests) {
  return step(cycle, kMayRequest && host_requests,
              [this](const CoreControl::Decision& /*decision*/, memory::PortMask granted) {
                return needs_pixel(granted);
              });
}

memory::PortMask FastForward::step(std::uint64_t cycle, bool host_requests) {
  leave_walk(cycle);
  stepped_.reset();
  return step_core<true>(cycle, host_requests);
}

std::uint64_t FastForward::run_ahead(std::uint64_t cycle, std::uint64_t end) {
  while (cycle < end && !control().frame_done()) {
    if (is_walking_) cycle = walk(cycle, end);
    if (cycle < end) cycle = step_group(cycle, end);
  }
  catch_up(cycle);
  return cycle;
}

FastForward::Served FastForward::serve_host(std::uint64_t& cycle, const Route& route, std::uint64_t first,
                                            std::size_t words) {
  if (!is_walking_) stepped_.reset();  // a group that is begun without the burst is not recorded
  route_host(cycle, route, first);
  if (ConflictRecorder* const conflicts = this->conflicts()) conflicts->set_host_traffic(route.traffic);
  host_ = {first, words, static_cast<std::uint8_t>(route.bank << 1U | std::size_t{route.write})};
  Served served;
  const std::uint64_t end = std::max(cycle, first) + kMostHostCycles;
  while (host_.words != 0 && cycle < end && !control().frame_done()) {
    if (is_walking_ && cycle < first) cycle = walk(cycle, first);
    if (const auto found = find_host(cycle)) {
      const HostGrants& grants = known_.host(*found);
      if (grants.words != 0) served.last_cycle = cycle + grants.cycles - 1;
      cycle += known_.progress(*found).cycles;
      host_.words -= grants.words;
      host_.first = cycle;
      follow(*found, cycle);
    } else {
      const std::size_t words_before = host_.words;
      cycle = step_group(cycle, end);
      if (host_.words != words_before) served.last_cycle = host_.first - 1;
    }
  }
  served.words = words - host_.words;
  if (host_.words != 0) {
    host_.words = 0;
    stepped_.reset();
  }
  return served;
}

// Routes the host to the bank. If a port was alone there until now, first runs the core up to `first`.
void FastForward::route_host(std::uint64_t& cycle, const Route& route, std::uint64_t first) {
  memory::Arbitration& arbitration = this->arbitration();
  const bool is_new = !arbitration.is_shared(route.bank);
  if (is_new) {
    cycle = run_ahead(cycle, std::max(cycle, first));
    stepped_.reset();
    leave_walk(cycle);
    for (const Side side : kSides) {
      if (arbitration.bank_of(pixel_port(side)) == route.bank) resolve_accesses(side);
    }
  }
  arbitration.visit(kHostPort, route.bank, route.write);
  is_host_routed_ = true;
  if (is_new) begin_walk(cycle);
}

// Steps to the end of the group or of the host's burst, but not beyond `end` or the end of the frame.
std::uint64_t FastForward::step_group(std::uint64_t cycle, std::uint64_t end) {
  if (is_walking_) end_walk(cycle);
  const auto is_over = [&] { return cycle >= end || completed_group() || control().frame_done(); };
  bool burst_ends = false;
  if (host_.words == 0) {
    do {
      step_core<false>(cycle++, false);
      cycle = skip_waiting(cycle, end);
    } while (!is_over());
  } else {
    do {
      const bool requests = cycle >= host_.first;
      const memory::PortMask granted = step_core<true>(cycle++, requests);
      if ((granted & memory::mask_of(kHostPort)) != 0) {
        host_.first = cycle;
        burst_ends = --host_.words == 0;
      }
      cycle = skip_waiting(cycle, std::min(end, host_.first));
    } while (!burst_ends && !is_over());
  }
  if (burst_ends || completed_group()) begin_walk(cycle);
  return cycle;
}

// Skips the cycles before `end` in which everything waits for the matcher. Returns the next cycle.
std::uint64_t FastForward::skip_waiting(std::uint64_t cycle, std::uint64_t end) {
  if (end <= cycle) return cycle;
  const std::uint64_t cycles = std::min(end - cycle, control().waiting_cycles());
  if (cycles != 0) control().skip_waiting(cycles);
  skipped_cycles_ += cycles;
  return cycle + cycles;
}

// Begins to follow transitions, if possible.
void FastForward::begin_walk(std::uint64_t cycle) {
  if (stepped_) end_stepped(cycle);
  if (!find_strips()) return;
  room_ = room();
  if (!holds_group(room_)) return;
  if (known_.is_full()) known_.clear();
  state_ = state(cycle);
  consumed_ = control().match().consumed();
  left_of_group_ = control().match().slots_of_group_left();
  is_walking_ = true;
  if (ConflictRecorder* const conflicts = this->conflicts()) conflicts->skip_from(cycle);
}

// Takes the core to the end of the walk.
void FastForward::leave_walk(std::uint64_t cycle) {
  if (!is_walking_) return;
  catch_up(cycle);
  is_walking_ = false;
}

// Leaves the walk, and records the transition that is stepped next if it is not known.
void FastForward::end_walk(std::uint64_t cycle) {
  leave_walk(cycle);
  if (!holds_group(room_)) return;
  const TransitionCache::Accesses accesses = this->accesses();
  if (host_.words == 0 && known_.find(state_, accesses)) return;
  stepped_ = {state_, accesses, host_, progress(cycle), control().counts(), control().match().part()};
  arbitration().begin_recording();
}

// Follows the transitions to the ends of groups that are over before `end`.
std::uint64_t FastForward::walk(std::uint64_t cycle, std::uint64_t end) {
  // A group has at least as many cycles as slots.
  if (left_of_group_ != slots_of_group() && end - cycle >= left_of_group_) {
    const auto found = known_.find(state_, accesses());
    Progress room = room_;
    room.cycles = end - cycle;
    if (found && known_.progress(*found).fits(room)) {
      cycle += known_.progress(*found).cycles;
      follow(*found, cycle);
    }
  }
  if (left_of_group_ != slots_of_group() || end - cycle < slots_of_group()) return cycle;
  do {
    Progress room = room_;
    room.cycles = end - cycle;
    if (const ConflictRecorder* const conflicts = this->conflicts())
      room.consumed = std::min(room.consumed, slots_to(conflicts->strip_end_column()));
    Progress skipped = room;
    state_ = varies() ? walk_varying(state_, room) : known_.walk(state_, {}, room, log());
    skipped.subtract(room);
    skip(skipped);
    cycle += skipped.cycles;
  } while (record_skipped(cycle, slots_of_group()));
  return cycle;
}

// The transition from `cycle` on, in which the host requests its words.
std::optional<TransitionCache::Transition> FastForward::find_host(std::uint64_t cycle) const {
  std::optional<HostRequests> requests = is_walking_ ? requests_of(host_, cycle) : std::nullopt;
  if (!requests) return std::nullopt;
  const TransitionCache::Accesses accesses = this->accesses();
  auto found = known_.find(state_, accesses, *requests);
  if (!found) {
    requests->words = HostRequests::kEndless;
    found = known_.find(state_, accesses, *requests);
    if (found && known_.host(*found).words >= host_.words) return std::nullopt;
  }
  return found && fits_host(*found) ? found : std::nullopt;
}

// Whether a transition with requests of the host can be followed. It may run on after its last slot. But
// after the last uniform slot the state in the cache differs from that of the core. So it must leave one.
bool FastForward::fits_host(const TransitionCache::Transition& transition) const {
  const Progress& progress = known_.progress(transition);
  return progress.fits(room_) && progress.consumed < room_.consumed;
}

// The requests of these words from `cycle` on. Nothing if the cache cannot hold them.
std::optional<HostRequests> FastForward::requests_of(const HostWords& host, std::uint64_t cycle) {
  const std::uint64_t first = host.first > cycle ? host.first - cycle : 0;
  if (first > HostRequests::kMostCycles) return std::nullopt;
  return HostRequests{static_cast<std::uint16_t>(first),
                      static_cast<std::uint16_t>(std::min<std::size_t>(host.words, HostRequests::kEndless)),
                      host.route};
}

// Follows one transition, which ends before `cycle`.
void FastForward::follow(const TransitionCache::Transition& transition, std::uint64_t cycle) {
  known_.follow(transition, 1, log());
  const HostGrants& host = known_.host(transition);
  host_ahead_.words += host.words;
  host_ahead_.requests += host.requests;
  state_ = transition.next;
  const std::uint64_t left_of_group = left_of_group_;
  skip(known_.progress(transition));
  record_skipped(cycle, left_of_group);
}

void FastForward::skip(const Progress& progress) {
  room_.subtract(progress);
  ahead_.add(progress);
  consumed_ += progress.consumed;
  if (progress.consumed < left_of_group_) {
    left_of_group_ -= progress.consumed;
  } else {
    left_of_group_ = slots_of_group() - (progress.consumed - left_of_group_) % slots_of_group();
  }
  skipped_cycles_ += progress.cycles;
}

// See record_skipped().
bool FastForward::hand_over(ConflictRecorder& conflicts, std::uint64_t cycle, std::uint64_t left_of_group) {
  if (in_order_.empty()) return false;
  for (auto next = in_order_.begin(); next != in_order_.end(); next += next->length) {
    const std::uint64_t consumed = known_.progress(next->effect).consumed;
    if (next->length == 1 && consumed < left_of_group) {
      conflicts.add_part(known_.conflicts(next->effect));
      left_of_group -= consumed;
      continue;
    }
    repeated_.clear();
    for (std::uint32_t step = 0; step < next->length; ++step)
      repeated_.push_back(&known_.conflicts((next + step)->effect));
    conflicts.repeat(repeated_.data(), repeated_.size(), next->times);
    left_of_group = slots_of_group();
  }
  in_order_.clear();
  if (!conflicts.is_at_strip_end()) return false;
  catch_up(cycle);
  conflicts.end_strip();
  return true;
}

// Takes the core and the arbiters to the state that the walk has reached.
void FastForward::catch_up(std::uint64_t cycle) {
  if (ahead_.cycles == 0) return;
  CoreControl& control = this->control();
  memory::Arbitration& arbitration = this->arbitration();
  known_.count_followed(control, arbitration);
  control.count_host(false, false, ahead_.cycles - host_ahead_.requests);
  control.count_host(true, false, host_ahead_.requests - host_ahead_.words);
  control.count_host(true, true, host_ahead_.words);
  memory::StateReader state = known_.state(state_).begin();
  control.skip_to(state, ahead_.consumed, ahead_.words);
  for (const Side side : kSides) control.correct_marks(side, marks(side));
  arbitration.set_state(cycle, state);
  ahead_ = {};
  host_ahead_ = {};
}

// Follows recorded transitions as far as `room` allows, and reduces `room`. Returns the next state.
FastForward::StateNumber FastForward::walk_varying(StateNumber state, Progress& room) {
  const std::uint64_t slots = slots_of_group();
  int alike = 0;  // groups with the accesses of the group before
  TransitionCache::Accesses before{};
  for (std::uint64_t consumed = consumed_;;) {
    const TransitionCache::Accesses accesses = accesses_from(consumed, slots);
    alike = consumed != consumed_ && accesses == before ? alike + 1 : 0;
    before = accesses;
    if (alike == kManyAlike) {
      alike = 0;
      const std::uint64_t left = room.consumed;
      state = walk_uniform(state, consumed, room);
      consumed += left - room.consumed;
      if (left != room.consumed) continue;
    }
    const auto found = known_.find(state, accesses);
    if (!found) return state;
    const Progress& progress = known_.progress(*found);
    if (!progress.fits(room)) return state;
    known_.follow_group(*found, log());
    room.subtract(progress);
    state = found->next;
    consumed += slots;
  }
}

// Follows groups with the same accesses. `consumed`: slots of the frame that are consumed before them.
FastForward::StateNumber FastForward::walk_uniform(StateNumber state, std::uint64_t consumed,
                                                   Progress& room) {
  Progress uniform = room;
  uniform.consumed = std::min(uniform.consumed, uniform_slots(consumed));
  Progress left = uniform;
  const StateNumber last = known_.walk(state, accesses_from(consumed, slots_of_group()), left, log());
  uniform.subtract(left);
  room.subtract(uniform);
  return last;
}

// Finds the run of strips (Strips) in which both lanes handle and take slots. Returns false if there is none.
bool FastForward::find_strips() {
  if (control().match().draining()) return true;
  const LaneControl& left = control().lane(Side::kLeft);
  const LaneControl& right = control().lane(Side::kRight);
  if (left.next_slot().done() || right.next_slot().done()) return false;
  while (all_strips_[strips_].end <= std::min(left.taken(), right.taken())) ++strips_;
  const std::uint64_t begin = strips_ == 0 ? 0 : all_strips_[strips_ - 1].end;
  return std::min(left.handled(), right.handled()) >= begin &&
         std::max(left.taken(), right.taken()) < all_strips_[strips_].end;
}

// Returns how far the core can run before this run of strips ends, MatchControl::part() changes, or a row of
// results is complete.
Progress FastForward::room() const {
  const bool drains = control().match().draining();
  // A port decides by the slot after the last one taken: that slot must be in the strips too.
  const auto slots = [this, drains](Side side) {
    return drains ? 0 : all_strips_[strips_].end - 1 - control().lane(side).taken();
  };
  return {UINT64_MAX, control().match().uniform_slots(), slots(Side::kLeft), slots(Side::kRight),
          rows().next_words() - control().result().words_written() - 1};
}

// Whether a whole group fits into `room`. If not, nothing may be recorded: after a walk up to the last
// uniform slot, the state in the cache differs from that of the core.
bool FastForward::holds_group(const Progress& room) const {
  const std::uint64_t slots = control().match().draining() ? 0 : slots_of_group();
  return room.consumed >= slots_of_group() && room.left_slots >= slots && room.right_slots >= slots;
}

// The accesses of all slots that are in the lanes while the matcher consumes `slots` slots. `consumed`: slots
// of the frame that are consumed before them.
TransitionCache::Accesses FastForward::accesses_from(std::uint64_t consumed, std::uint64_t slots) const {
  TransitionCache::Accesses accesses{};
  const std::size_t words = known_.words_of_side();
  const std::uint64_t in_use = slots + lane_fifo_slots_;  // bits of a side
  for (std::size_t side = 0; side < varying_.size(); ++side) {
    if (varying_[side] == nullptr) continue;
    std::uint64_t* const of_side = accesses.data() + side * words;
    for (std::size_t word = 0; 64 * word < in_use; ++word)
      of_side[word] = varying_[side]->pixels_of_slots(consumed + 64 * word);
    if (in_use % 64 != 0) of_side[in_use / 64] &= (std::uint64_t{1} << in_use % 64) - 1;
  }
  return accesses;
}

// The number of slots from slot `consumed` on over which accesses_from() stays the same, group after group.
std::uint64_t FastForward::uniform_slots(std::uint64_t consumed) const {
  std::uint64_t uniform = UINT64_MAX;
  for (const AccessPattern* pattern : varying_) {
    if (pattern == nullptr) continue;
    const std::uint64_t end = pattern->uniform_until(consumed);
    const std::uint64_t last = consumed + lane_fifo_slots_;
    uniform = std::min(uniform, end < last ? 0 : end - last);
  }
  return uniform;
}

// The accesses of the slots in the lanes up to the end of the group, from the state of the walk on.
TransitionCache::Accesses FastForward::accesses() const {
  return varies() ? accesses_from(consumed_, left_of_group_) : TransitionCache::Accesses{};
}

// Records the transition that has just been stepped. Does not if the next state depends on the position in
// the frame too: a lane has left its run of strips (Strips), or MatchControl::part() has changed.
void FastForward::end_stepped(std::uint64_t cycle) {
  const Stepped stepped = *stepped_;
  stepped_.reset();
  TransitionCache::Effect effect{progress(cycle),
                                 CoreControl::difference(control().counts(), stepped.counts),
                                 arbitration().take_recorded(),
                                 {}};
  effect.progress.subtract(stepped.begin);
  HostRequests requests;
  if (stepped.host.words != 0 && stepped.host.first < cycle) {  // the host has requested
    const std::optional<HostRequests> host = requests_of(stepped.host, stepped.begin.cycles);
    if (!host || effect.progress.cycles > HostRequests::kMostCycles) return;
    requests = *host;
    const std::uint64_t end = host_.words != 0 ? cycle : host_.first;  // of the requests
    effect.host.words = stepped.host.words - host_.words;
    effect.host.requests = end - stepped.begin.cycles - requests.first;
    if (effect.host.words != 0) effect.host.cycles = host_.first - stepped.begin.cycles;
    if (host_.words != 0) requests.words = HostRequests::kEndless;
  }
  const auto is_beyond = [this](Side side) {
    return !control().match().draining() && control().lane(side).taken() >= all_strips_[strips_].end;
  };
  if (stepped.part != control().match().part() || is_beyond(Side::kLeft) || is_beyond(Side::kRight)) return;
  known_.record(stepped.state, stepped.accesses, requests, state(cycle), effect, arbitration());
}

// The progress up to `cycle`. Its beginning is arbitrary: only differences have a meaning.
Progress FastForward::progress(std::uint64_t cycle) const {
  return {cycle, control().match().consumed(), control().lane(Side::kLeft).taken(),
          control().lane(Side::kRight).taken(), control().result().words_written()};
}

FastForward::StateNumber FastForward::state(std::uint64_t cycle) {
  const std::uint64_t varies = std::uint64_t{varying_[0] != nullptr} | std::uint64_t{varying_[1] != nullptr}
                                                                           << 1U;
  const memory::Arbitration& arbitration = this->arbitration();
  const std::uint64_t host =
      arbitration.is_routed(kHostPort) && !is_host_routed_
          ? arbitration.bank_of(kHostPort) << 2U | std::uint64_t{arbitration.writes(kHostPort)} << 1U | 1U
          : 0;
  state_words_.clear();
  control().append_state(state_words_);
  arbitration.append_state(cycle, state_words_);
  state_words_.push_back(control().match().draining() ? 0 : all_strips_[strips_].empty);
  state_words_.push_back(banks_ << 32U | host << 2U | varies);
  state_words_.push_back(arbitration.shared());
  return known_.number_of(state_words_, {control().lane(Side::kLeft).handled_slots(),
                                         control().lane(Side::kRight).handled_slots()});
}

}  // namespace stereotlm::fpga
