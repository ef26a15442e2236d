#include "models/fpga/fast_forward.h"

#include <algorithm>
#include <utility>

namespace stereotlm::fpga {
namespace {

// After this number of groups with the same accesses, the walk expects more groups with these accesses.
constexpr int kManyAlike = 8;
// The largest number of cycles that one call of serve_host() runs from the first request on.
constexpr std::uint64_t kMostHostCycles = std::uint64_t{1} << 13U;

// The empty slots of a column of a strip: bit k for slot k.
std::uint64_t empty_slots(const FrameGeometry& geometry, int strip) {
  std::uint64_t empty = 0;
  for (int k = 0; k < geometry.slots_per_column; ++k) {
    const int row = geometry.first_row_of(strip) + k;
    empty |= std::uint64_t{!geometry.is_inside(row)} << k;
  }
  return empty;
}

std::size_t most_slots_of_group(const FrameGeometry& geometry, int lane_fifo_slots) {
  return static_cast<std::size_t>(4 * geometry.slots_per_column + lane_fifo_slots);
}

}  // namespace

FastForward::FastForward(CoreStepper& stepper, int lane_fifo_slots, std::size_t most_groups)
    : stepper_(stepper),
      lane_fifo_slots_(static_cast<std::uint64_t>(lane_fifo_slots)),
      accesses_(stepper),
      known_(most_slots_of_group(control().geometry(), lane_fifo_slots), most_groups) {
  const FrameGeometry& geometry = control().geometry();
  for (int strip = 0; strip < geometry.strips; ++strip) {
    const std::uint64_t empty = empty_slots(geometry, strip);
    if (all_strips_.empty() || all_strips_.back().empty != empty) all_strips_.push_back({0, empty});
    all_strips_.back().end = (static_cast<std::uint64_t>(strip) + 1) * geometry.columns_per_strip() *
                             static_cast<std::uint64_t>(geometry.slots_per_column);
  }
}

void FastForward::start_direct_frame(const AccessPatterns& patterns, std::uint64_t routes) {
  accesses_.start_direct_frame(patterns);
  known_.keep_order(stepper_.conflicts() != nullptr);
  tell_assumed();
  stepped_.reset();
  is_walking_ = false;
  routes_ = routes;
  strips_ = 0;
  for (const Side side : kSides) varying_[index_of(side)] = accesses_.varying(side);
  const std::array<std::uint64_t, 2> versions = {patterns[0].version(), patterns[1].version()};
  if (&patterns != patterns_ || versions != versions_) followed_.clear();
  patterns_ = &patterns;
  versions_ = versions;
}

void FastForward::start_stepped_frame() {
  accesses_.start_stepped_frame();
  stepped_.reset();
  is_walking_ = false;
}

void FastForward::settle() {
  stepped_.reset();
  is_walking_ = false;
  granting_.reset();
  accesses_.resolve();
  tell_assumed();
  for (const Side side : kSides) varying_[index_of(side)] = accesses_.varying(side);
  if (is_host_routed_) stepper_.arbitration().unroute(kHostPort);
  is_host_routed_ = false;
}

void FastForward::tell_assumed() {
  if (ConflictRecorder* const conflicts = stepper_.conflicts())
    conflicts->assume_accesses({accesses_.assumed(Side::kLeft), accesses_.assumed(Side::kRight)});
}

// `kMayRequest`: false where the host requests in no cycle, which is most of them and costs less.
template <bool kMayRequest>
memory::PortMask FastForward::step_core(std::uint64_t cycle, bool host_requests) {
  return stepper_.step(cycle, kMayRequest && host_requests,
                       [this](const CoreControl::Decision& /*decision*/, memory::PortMask granted) {
                         return accesses_.needs_pixel(granted);
                       });
}

memory::PortMask FastForward::step(std::uint64_t cycle, bool host_requests) {
  is_walking_ = false;
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
  cycle = walk_to_burst(cycle, first);
  if (!is_walking_) stepped_.reset();  // a group that is begun before the burst is not recorded
  keeps_route_ = true;
  route_host(cycle, route);
  if (ConflictRecorder* const conflicts = stepper_.conflicts()) conflicts->set_host_traffic(route.traffic);
  host_ = {first, words};
  const Served served = grant_words(cycle);
  trust(route.write).note(keeps_route_);
  if (!granting_ && host_.words != 0) {
    host_ = {};
    stepped_.reset();
  }
  return served;
}

// Runs to the beginning of the group in which the burst begins; to `first` if it is not certain which group
// that is, unless the host is routed already.
std::uint64_t FastForward::walk_to_burst(std::uint64_t cycle, std::uint64_t first) {
  while (cycle < first && !control().frame_done()) {
    if (is_walking_) cycle = walk(cycle, first);
    // A group has at least as many cycles as slots.
    if (is_walking_ && !granting_ &&
        (is_host_routed_ || first - cycle < slots_of_group() || known_.find(state_, accesses())))
      return cycle;
    if (cycle < first) cycle = step_group(cycle, first);
  }
  return cycle;
}

// Runs until the words of host_ are granted, or as far as serve_host() does.
FastForward::Served FastForward::grant_words(std::uint64_t& cycle) {
  Served served;
  const std::size_t words = host_.words;
  const std::uint64_t end = std::max(cycle, host_.first) + kMostHostCycles;
  while (host_.words != 0 && cycle < end && !control().frame_done()) {
    if (is_walking_ && cycle < host_.first) cycle = walk(cycle, host_.first);
    const auto found = is_walking_ ? find_host(cycle) : std::nullopt;
    if (!found) {
      keeps_route_ = false;
      const std::size_t words_before = host_.words;
      cycle = step_group(cycle, end);
      if (host_.words != words_before) served.last_cycle = host_.first - 1;
      continue;
    }
    const HostGrants& grants = known_.host(*found);
    if (grants.words != 0) served.last_cycle = cycle + grants.cycles - 1;
    if (grants.words == host_.words) {
      granting_ = found;
      served.words = words;
      return served;
    }
    cycle += known_.progress(*found).cycles;
    follow(*found);
    record_skipped(cycle);
    host_ = {cycle, host_.words - grants.words};
  }
  served.words = words - host_.words;
  return served;
}

// Routes the host to the bank, and keeps walking if a walk has begun.
void FastForward::route_host(std::uint64_t cycle, const Route& route) {
  memory::Arbitration& arbitration = stepper_.arbitration();
  if (is_host_routed_ && arbitration.bank_of(kHostPort) == route.bank &&
      arbitration.writes(kHostPort) == route.write)
    return;
  catch_up(cycle);
  const bool was_walking = is_walking_;
  settle();
  arbitration.route(kHostPort, route.bank, route.write);
  is_host_routed_ = true;
  if (was_walking) begin_walk(cycle);
}

// Steps to the end of the group, at most up to `end`, or until the last word of the host is granted, or the
// frame is done.
std::uint64_t FastForward::step_group(std::uint64_t cycle, std::uint64_t end) {
  if (is_walking_) end_walk(cycle);
  const auto is_over = [&] { return cycle >= end || stepper_.completed_group() || control().frame_done(); };
  if (host_.words == 0) {
    do step_core<false>(cycle++, false);
    while (!is_over());
  } else {
    do {
      const bool requests = cycle >= host_.first;
      const memory::PortMask granted = step_core<true>(cycle++, requests);
      if ((granted & memory::mask_of(kHostPort)) != 0) host_ = {cycle, host_.words - 1};
    } while (host_.words != 0 && !is_over());
  }
  if (stepper_.completed_group()) begin_walk(cycle);
  return cycle;
}

// Begins to follow transitions, if possible. Called after a group of four columns has been stepped.
void FastForward::begin_walk(std::uint64_t cycle) {
  if (stepped_) end_group(cycle);
  // Without the route of the host more ports are uncontended.
  if (is_host_routed_ && !keeps_route_ && host_.words == 0) settle();
  if (!find_strips()) return;
  room_ = room();
  if (!holds_group(room_)) return;
  if (known_.is_full()) {
    known_.clear();
    followed_.clear();
  }
  state_ = state(cycle);
  consumed_ = control().match().columns() * slots_of_group() / 4;
  is_walking_ = true;
}

// Takes the core to the end of the walk, and records the group that is stepped next if it is not known.
void FastForward::end_walk(std::uint64_t cycle) {
  catch_up(cycle);
  is_walking_ = false;
  const bool is_known = granting_.has_value();
  granting_.reset();
  if (is_known || !holds_group(room_)) return;
  const TransitionCache::Accesses accesses = this->accesses();
  if (host_.words == 0 && known_.find(state_, accesses)) return;
  stepped_ = {state_,          accesses,           host_requests(cycle),     host_.words,
              progress(cycle), control().counts(), control().match().state()};
  stepper_.arbitration().begin_recording();
}

// Follows the transitions of whole groups that are over before `end`.
std::uint64_t FastForward::walk(std::uint64_t cycle, std::uint64_t end) {
  if (granting_) {
    const std::uint64_t cycles = known_.progress(*granting_).cycles;
    if (cycles > end - cycle) return cycle;
    cycle += cycles;
    follow(*granting_);
    record_skipped(cycle);
    granting_.reset();
    host_ = {};
  }
  do {
    Progress room = room_;
    room.cycles = end - cycle;
    if (ConflictRecorder* const conflicts = stepper_.conflicts())
      room.columns = std::min(room.columns, conflicts->columns_to_strip_end());
    Progress skipped = room;
    state_ = walk_known(state_, room);
    skipped.subtract(room);
    skip(skipped);
    cycle += skipped.cycles;
  } while (record_skipped(cycle));
  return cycle;
}

// The transition of the group from `cycle` on, in which the host requests its words.
std::optional<TransitionCache::Transition> FastForward::find_host(std::uint64_t cycle) const {
  const TransitionCache::Accesses accesses = this->accesses();
  HostRequests requests = host_requests(cycle);
  if (requests.words == 0) return std::nullopt;
  auto found = known_.find(state_, accesses, requests);
  if (!found) {
    requests.words = HostRequests::kEndless;
    found = known_.find(state_, accesses, requests);
    if (found && known_.host(*found).words >= host_.words) return std::nullopt;
  }
  return found && known_.progress(*found).fits(room_) ? found : std::nullopt;
}

// The requests of host_ in the group from `cycle` on. None if a memo cannot hold them.
HostRequests FastForward::host_requests(std::uint64_t cycle) const {
  if (host_.words == 0) return {};
  const std::uint64_t first = host_.first > cycle ? host_.first - cycle : 0;
  if (first > HostRequests::kMostCycles) return {};
  return {static_cast<std::uint16_t>(first),
          static_cast<std::uint16_t>(std::min<std::size_t>(host_.words, HostRequests::kEndless))};
}

void FastForward::follow(const TransitionCache::Transition& transition) {
  known_.follow(transition);
  const HostGrants& host = known_.host(transition);
  host_ahead_.words += host.words;
  host_ahead_.requests += host.requests;
  state_ = transition.next;
  skip(known_.progress(transition));
}

void FastForward::skip(const Progress& progress) {
  room_.subtract(progress);
  ahead_.add(progress);
  consumed_ += progress.columns * slots_of_group() / 4;
  skipped_cycles_ += progress.cycles;
}

// See record_skipped().
bool FastForward::hand_over(ConflictRecorder& conflicts, std::uint64_t cycle) {
  if (known_.in_order().empty()) return false;
  const std::vector<TransitionCache::InOrder>& in_order = known_.in_order();
  for (auto next = in_order.begin(); next != in_order.end(); next += next->length) {
    if (next->length == 1) {
      const GroupConflicts* const group = &known_.conflicts(next->effect);
      conflicts.repeat(&group, 1, next->times, stepper_.arbitration());
      continue;
    }
    repeated_.clear();
    for (std::uint32_t step = 0; step < next->length; ++step) known_.conflicts((next + step)->effect);
    for (std::uint32_t step = 0; step < next->length; ++step)
      repeated_.push_back(&known_.conflicts((next + step)->effect));
    conflicts.repeat(repeated_.data(), repeated_.size(), next->times, stepper_.arbitration());
  }
  known_.forget_order();
  if (!conflicts.is_at_strip_end()) return false;
  catch_up(cycle);
  conflicts.end_strip(control(), stepper_.arbitration());
  return true;
}

// Takes the core and the arbiters to the state that the walk has reached.
void FastForward::catch_up(std::uint64_t cycle) {
  if (ahead_.cycles == 0) return;
  CoreControl& control = stepper_.control();
  memory::Arbitration& arbitration = stepper_.arbitration();
  known_.count_followed(control, arbitration);
  control.count_host(false, false, ahead_.cycles - host_ahead_.requests);
  control.count_host(true, false, host_ahead_.requests - host_ahead_.words);
  control.count_host(true, true, host_ahead_.words);
  control.skip_to(known_.state(state_).control, ahead_.columns, ahead_.words);
  for (const Side side : kSides) control.correct_marks(side, accesses_.marks(side));
  arbitration.skip_to(known_.state(state_).arbitration, cycle, ahead_.cycles);
  ahead_ = {};
  host_ahead_ = {};
}

// Follows recorded transitions as far as there is room, which it reduces. Returns the state that comes next.
FastForward::StateNumber FastForward::walk_known(StateNumber state, Progress& room) {
  const bool varies = !control().match().draining() && (varying_[0] != nullptr || varying_[1] != nullptr);
  return varies ? walk_varying(state, room) : known_.walk(state, {}, room);
}

FastForward::StateNumber FastForward::walk_varying(StateNumber state, Progress& room) {
  const std::uint64_t slots = slots_of_group();
  if (followed_.empty()) followed_.resize(control().geometry().slots / slots + 1);
  int alike = 0;  // groups with the accesses of the group before
  for (std::uint64_t consumed = consumed_;;) {
    Followed& followed = followed_[consumed / slots];
    TransitionCache::Transition transition;
    if (followed.state == state) {
      transition = followed.transition;
      alike = 0;
    } else {
      const TransitionCache::Accesses accesses = accesses_from(consumed);
      const bool is_alike = consumed >= slots && accesses == accesses_from(consumed - slots);
      alike = is_alike ? alike + 1 : 0;
      if (alike == kManyAlike) {
        alike = 0;
        const std::uint64_t columns = room.columns;
        state = walk_uniform(state, consumed, room);
        consumed += (columns - room.columns) / 4 * slots;
        if (columns != room.columns) continue;
      }
      const auto found = known_.find(state, accesses);
      if (!found) return state;
      transition = *found;
      if (!is_alike) followed = {state, transition};
    }
    const Progress& progress = known_.progress(transition);
    if (!progress.fits(room)) return state;
    known_.follow(transition);
    room.subtract(progress);
    state = transition.next;
    consumed += slots;
  }
}

// Walks over groups with the same accesses. `consumed`: slots of the frame that are consumed before.
FastForward::StateNumber FastForward::walk_uniform(StateNumber state, std::uint64_t consumed,
                                                   Progress& room) {
  Progress uniform = room;
  uniform.columns = std::min(uniform.columns, uniform_columns(consumed));
  Progress left = uniform;
  const StateNumber last = known_.walk(state, accesses_from(consumed), left);
  uniform.subtract(left);
  room.subtract(uniform);
  return last;
}

// Finds the strips in which both lanes handle and take their next slots. Returns false if there are none.
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

// Returns how far the core can run before the strips end, or a row of results is complete.
Progress FastForward::room() const {
  const bool drains = control().match().draining();
  // A port decides by the slot after the last one taken: that slot must be in the strips too.
  const auto slots = [this, drains](Side side) {
    return drains ? 0 : all_strips_[strips_].end - 1 - control().lane(side).taken();
  };
  return {UINT64_MAX, control().match().uniform_columns(), slots(Side::kLeft), slots(Side::kRight),
          stepper_.rows().next_words() - control().result().words_written() - 1};
}

// Whether a whole group fits into `room`. If not, no group may be recorded: after a walk up to the last
// uniform column, the state of the memo differs from that of the core.
bool FastForward::holds_group(const Progress& room) const {
  const std::uint64_t slots = control().match().draining() ? 0 : slots_of_group();
  return room.columns >= 4 && room.left_slots >= slots && room.right_slots >= slots;
}

// The accesses of the slots in the lanes during a group, before which `consumed` slots are consumed.
TransitionCache::Accesses FastForward::accesses_from(std::uint64_t consumed) const {
  TransitionCache::Accesses accesses{};
  const std::size_t words = known_.words_of_side();
  const std::uint64_t beyond = (slots_of_group() + lane_fifo_slots_) % 64;  // bits in use of the last word
  for (std::size_t side = 0; side < varying_.size(); ++side) {
    if (varying_[side] == nullptr) continue;
    std::uint64_t* const of_side = accesses.data() + side * words;
    for (std::size_t word = 0; word < words; ++word)
      of_side[word] = varying_[side]->pixels_of_slots(consumed + 64 * word);
    if (beyond != 0) of_side[words - 1] &= (std::uint64_t{1} << beyond) - 1;
  }
  return accesses;
}

// The number of columns from slot `consumed` on over which accesses_from() stays the same, group after group.
std::uint64_t FastForward::uniform_columns(std::uint64_t consumed) const {
  const std::uint64_t slots_per_column = slots_of_group() / 4;
  std::uint64_t columns = UINT64_MAX;
  for (const AccessPattern* pattern : varying_) {
    if (pattern == nullptr) continue;
    const std::uint64_t slots = pattern->uniform_until(consumed / slots_per_column) * slots_per_column;
    const std::uint64_t last = consumed + lane_fifo_slots_;
    columns = std::min(columns, slots < last ? 0 : (slots - last) / slots_per_column);
  }
  return columns;
}

// The accesses of the slots in the lanes during the group that comes next in the walk.
TransitionCache::Accesses FastForward::accesses() const {
  return control().match().draining() ? TransitionCache::Accesses{} : accesses_from(consumed_);
}

// Records the transition of the group that has just been stepped. Does not record it if the next state
// depends on the position in the frame, and not on the state before the group alone: a lane has left the
// current run of equal strips (Strips), or MatchControl::state() has changed.
void FastForward::end_group(std::uint64_t cycle) {
  const Stepped stepped = *stepped_;
  stepped_.reset();
  TransitionCache::Effect effect{progress(cycle),
                                 CoreControl::difference(control().counts(), stepped.counts),
                                 stepper_.arbitration().take_recorded(),
                                 {}};
  effect.progress.subtract(stepped.begin);
  HostRequests host = stepped.host;
  if (host.first >= effect.progress.cycles) host = {};  // the host requests after this group
  if (host.words != 0) {
    if (effect.progress.cycles > HostRequests::kMostCycles) return;
    const std::uint64_t end = host_.words != 0 ? cycle : host_.first;  // of the requests
    effect.host.words = stepped.host_words - host_.words;
    effect.host.requests = end - stepped.begin.cycles - host.first;
    if (effect.host.words != 0) effect.host.cycles = host_.first - stepped.begin.cycles;
    if (host_.words != 0) host.words = HostRequests::kEndless;
  }
  const auto is_beyond = [this](Side side) {
    return !control().match().draining() && control().lane(side).taken() >= all_strips_[strips_].end;
  };
  if (stepped.match != control().match().state() || is_beyond(Side::kLeft) || is_beyond(Side::kRight)) return;
  known_.record(stepped.state, stepped.accesses, host, state(cycle), effect);
}

// The progress up to `cycle`. Its beginning is arbitrary: only differences have a meaning.
Progress FastForward::progress(std::uint64_t cycle) const {
  return {cycle, control().match().columns(), control().lane(Side::kLeft).taken(),
          control().lane(Side::kRight).taken(), control().result().words_written()};
}

FastForward::StateNumber FastForward::state(std::uint64_t cycle) {
  const std::uint64_t varies = std::uint64_t{varying_[0] != nullptr} | std::uint64_t{varying_[1] != nullptr}
                                                                           << 1U;
  const memory::Arbitration& arbitration = stepper_.arbitration();
  const std::uint64_t host =
      arbitration.is_routed(kHostPort)
          ? arbitration.bank_of(kHostPort) << 2U | std::uint64_t{arbitration.writes(kHostPort)} << 1U | 1U
          : 0;
  return known_.number_of({control().state(), arbitration.state(cycle),
                           control().match().draining() ? 0 : all_strips_[strips_].empty,
                           routes_ << 32U | host << 2U | varies});
}

}  // namespace stereotlm::fpga
