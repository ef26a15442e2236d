#include "models/fpga/fast_forward.h"

#include <algorithm>

namespace stereotlm::fpga {
namespace {

// After as many groups with the same accesses the walk expects more of them.
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
  stepped_.reset();
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
}

void FastForward::settle() {
  stepped_.reset();
  accesses_.resolve();
  for (const Side side : kSides) varying_[index_of(side)] = accesses_.varying(side);
}

memory::PortMask FastForward::step(std::uint64_t cycle, bool host_requests) {
  return stepper_.step(cycle, host_requests,
                       [this](const CoreControl::Decision& /*decision*/, memory::PortMask granted) {
                         return accesses_.needs_pixel(granted);
                       });
}

std::uint64_t FastForward::run_ahead(std::uint64_t cycle, std::uint64_t end) {
  while (cycle < end && !control().frame_done()) {
    step(cycle, false);
    ++cycle;
    if (stepper_.completed_group()) cycle = skip_known(cycle, end);
  }
  return cycle;
}

// Skips groups whose transitions are recorded. Called after a group of four columns.
std::uint64_t FastForward::skip_known(std::uint64_t cycle, std::uint64_t end) {
  memory::Arbitration& arbitration = stepper_.arbitration();
  // The host may contend for a bank that is uncontended without it.
  if (arbitration.is_routed(kHostPort)) return cycle;
  if (stepped_) end_group(cycle);
  if (!find_strips()) return cycle;
  const Progress room = this->room(cycle, end);
  if (!holds_group(room)) return cycle;
  if (known_.is_full()) {
    known_.clear();
    followed_.clear();
  }
  const StateNumber first = state(cycle);
  Progress left = room;
  const StateNumber last = walk(first, left);
  if (left.cycles != room.cycles) {
    Progress skipped = room;
    skipped.subtract(left);
    cycle += skipped.cycles;
    skipped_cycles_ += skipped.cycles;
    CoreControl& control = stepper_.control();
    known_.count_followed(control, arbitration);
    control.count_host(false, false, skipped.cycles);
    control.skip_to(known_.state(last).control, skipped.columns, skipped.words);
    for (const Side side : kSides) control.correct_marks(side, accesses_.marks(side));
    arbitration.skip_to(known_.state(last).arbitration, cycle, skipped.cycles);
  }
  if (!holds_group(left)) return cycle;
  TransitionCache::Accesses accesses{};  // none in the drain
  if (!control().match().draining()) accesses = accesses_from(consumed());
  if (!known_.find(last, accesses)) begin_group(last, accesses, cycle);
  return cycle;
}

// Follows recorded transitions as far as there is room, which it reduces. Returns the state that comes next.
FastForward::StateNumber FastForward::walk(StateNumber state, Progress& room) {
  const bool varies = !control().match().draining() && (varying_[0] != nullptr || varying_[1] != nullptr);
  return varies ? walk_varying(state, room) : known_.walk(state, {}, room);
}

FastForward::StateNumber FastForward::walk_varying(StateNumber state, Progress& room) {
  const std::uint64_t slots = slots_of_group();
  if (followed_.empty()) followed_.resize(control().geometry().slots / slots + 1);
  int alike = 0;  // groups with the accesses of the group before
  for (std::uint64_t consumed = this->consumed();;) {
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
Progress FastForward::room(std::uint64_t cycle, std::uint64_t end) const {
  const bool drains = control().match().draining();
  // A port decides by the slot after the last one taken: that slot must be in the strips too.
  const auto slots = [this, drains](Side side) {
    return drains ? 0 : all_strips_[strips_].end - 1 - control().lane(side).taken();
  };
  return {end - cycle, control().match().uniform_columns(), slots(Side::kLeft), slots(Side::kRight),
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

void FastForward::begin_group(StateNumber state, const TransitionCache::Accesses& accesses,
                              std::uint64_t cycle) {
  stepped_ = {state, accesses, progress(cycle), control().counts(), control().match().state()};
  stepper_.arbitration().begin_recording();
}

// Records the transition of the group that has just been stepped, unless the state after it is not that of
// other groups: the strips have ended, or MatchControl::state() has changed.
void FastForward::end_group(std::uint64_t cycle) {
  const Stepped stepped = *stepped_;
  stepped_.reset();
  TransitionCache::Effect effect{progress(cycle), CoreControl::difference(control().counts(), stepped.counts),
                                 stepper_.arbitration().take_recorded()};
  effect.progress.subtract(stepped.begin);
  const auto is_beyond = [this](Side side) {
    return !control().match().draining() && control().lane(side).taken() >= all_strips_[strips_].end;
  };
  if (stepped.match != control().match().state() || is_beyond(Side::kLeft) || is_beyond(Side::kRight)) return;
  known_.record(stepped.state, stepped.accesses, state(cycle), effect);
}

// The progress up to `cycle`. Its beginning is arbitrary: only differences have a meaning.
Progress FastForward::progress(std::uint64_t cycle) const {
  return {cycle, control().match().columns(), control().lane(Side::kLeft).taken(),
          control().lane(Side::kRight).taken(), control().result().words_written()};
}

FastForward::StateNumber FastForward::state(std::uint64_t cycle) {
  const std::uint64_t varies = std::uint64_t{varying_[0] != nullptr} | std::uint64_t{varying_[1] != nullptr}
                                                                           << 1U;
  return known_.number_of({control().state(), stepper_.arbitration().state(cycle),
                           control().match().draining() ? 0 : all_strips_[strips_].empty,
                           routes_ << 2U | varies});
}

}  // namespace stereotlm::fpga
