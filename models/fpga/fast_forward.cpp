#include "models/fpga/fast_forward.h"

#include <algorithm>

namespace stereotlm::fpga {

void FastForward::forget() {
  stepped_.reset();
  known_.clear();
  uniform_to_ = {};
}

void FastForward::settle() {
  stepped_.reset();
  if (accesses_.resolve()) forget();
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
  if (known_.is_full()) forget();
  if (stepped_) end_group(cycle);
  if (!has_uniform_slots()) return cycle;
  Progress left = room(cycle, end);
  if (!holds_group(left)) return cycle;
  TransitionCache::Group* group = &known_.at(state(cycle));
  if (group->next != nullptr) {
    Progress skipped;
    group = &known_.walk(*group, left, skipped, stepper_.control(), arbitration);
    if (skipped.cycles == 0) return cycle;
    cycle += skipped.cycles;
    left.subtract(skipped);
    stepper_.control().count_host(false, false, skipped.cycles);
    stepper_.control().skip_to(group->begin->control, skipped.columns, skipped.words);
    arbitration.skip_to(group->begin->arbitration, cycle, skipped.cycles);
  }
  if (group->next == nullptr && holds_group(left)) begin_group(*group, cycle);
  return cycle;
}

// Whether the slots to be taken next lie in a run of uniform columns. Clears the cache at the beginning of
// another run.
bool FastForward::has_uniform_slots() {
  if (control().match().draining()) return true;
  const auto lane = [this](Side side) -> const LaneControl& { return control().lane(side); };
  if (lane(Side::kLeft).next_slot().done() || lane(Side::kRight).next_slot().done()) return false;
  if (std::any_of(kSides.begin(), kSides.end(),
                  [&](Side side) { return lane(side).taken() >= uniform_to_[index_of(side)]; })) {
    forget();
    for (const Side side : kSides) uniform_to_[index_of(side)] = uniform_slots(side);
  }
  return true;
}

// The number of slots of the frame up to the end of the run of uniform columns.
std::uint64_t FastForward::uniform_slots(Side side) const {
  return accesses_.uniform_until(side) * static_cast<std::uint64_t>(control().geometry().slots_per_column);
}

// Returns how far the core can run before a run of uniform columns ends, or a row of results is complete.
Progress FastForward::room(std::uint64_t cycle, std::uint64_t end) const {
  const bool drains = control().match().draining();
  // A port decides by the slot after the last one taken: that slot must be in the run too.
  const auto slots = [this, drains](Side side) {
    return drains ? 0 : uniform_to_[index_of(side)] - 1 - control().lane(side).taken();
  };
  return {end - cycle, control().match().uniform_columns(), slots(Side::kLeft), slots(Side::kRight),
          stepper_.rows().next_words() - control().result().words_written() - 1};
}

// Whether a whole group fits into `room`. If not, no group may be recorded: after a walk up to the last
// uniform column, the state of the cached group differs from that of the core.
bool FastForward::holds_group(const Progress& room) const {
  const std::uint64_t slots = control().match().draining()
                                  ? 0
                                  : 4 * static_cast<std::uint64_t>(control().geometry().slots_per_column);
  return room.columns >= 4 && room.left_slots >= slots && room.right_slots >= slots;
}

void FastForward::begin_group(TransitionCache::Group& group, std::uint64_t cycle) {
  stepped_ = {&group, progress(cycle), control().counts()};
  stepper_.arbitration().begin_recording();
}

// Records the transition of the group that has just been stepped. If the group has crossed the end of its run
// of slots, has_uniform_slots() clears the cache immediately afterwards. If the slots have ended, or
// MatchControl::state() has changed, the state before the group does not recur in this frame.
void FastForward::end_group(std::uint64_t cycle) {
  TransitionCache::Group& group = *stepped_->group;
  group.progress = progress(cycle);
  group.progress.subtract(stepped_->begin);
  group.counts = CoreControl::difference(control().counts(), stepped_->counts);
  group.decided = stepper_.arbitration().take_recorded();
  group.next = &known_.at(state(cycle));
  stepped_.reset();
}

// The progress up to `cycle`. Its beginning is arbitrary: only differences have a meaning.
Progress FastForward::progress(std::uint64_t cycle) const {
  return {cycle, control().match().columns(), control().lane(Side::kLeft).taken(),
          control().lane(Side::kRight).taken(), control().result().words_written()};
}

}  // namespace stereotlm::fpga
