#include "models/fpga/core_timing.h"

namespace stereotlm::fpga {
namespace {

constexpr bool has(memory::PortMask mask, memory::Port port) { return (mask & memory::mask_of(port)) != 0; }

}  // namespace

CoreTiming::CoreTiming(const CoreConfig& config, memory::Arbitration& arbitration, std::size_t most_groups)
    : control_(config),
      rows_(control_.geometry()),
      arbitration_(arbitration),
      all_valid_(control_.geometry()),
      known_(most_groups) {}

void CoreTiming::start_frame(const FrameLatencies& latencies) {
  control_.start_frame(latencies);
  rows_.start_frame(control_);
  left_ = {};
  right_ = {};
  forget();
}

void CoreTiming::start_frame(const FrameLatencies& latencies, const AccessPattern& left,
                             const AccessPattern& right) {
  start_frame(latencies);
  left_ = {&left, !arbitration_.is_alone(memory::Port::kLeftPixel)};
  right_ = {&right, !arbitration_.is_alone(memory::Port::kRightPixel)};
}

void CoreTiming::host_route_changes() {
  stepped_.reset();
  resolve_validity();
}

void CoreTiming::forget() {
  stepped_.reset();
  known_.clear();
  left_uniform_to_ = 0;
  right_uniform_to_ = 0;
}

void CoreTiming::resolve_validity() {
  resolve_validity(left_, memory::Port::kLeftPixel, control_.left());
  resolve_validity(right_, memory::Port::kRightPixel, control_.right());
}

// From now on the validity of entries is tracked. The grants that were counted provisionally are corrected.
void CoreTiming::resolve_validity(Side& side, memory::Port port, LaneControl& lane) {
  if (side.tracks_validity) return;
  side.tracks_validity = true;
  forget();
  const std::uint64_t passed = side.pattern->invalid_before(lane.handled());
  std::uint64_t marks = 0;
  for (std::uint64_t slot = lane.handled(); slot < lane.taken(); ++slot)
    marks |= std::uint64_t{side.pattern->needs_pixel(slot)} << (slot - lane.handled());
  lane.correct_passes(passed, marks);
  arbitration_.retract_grants(port, passed);
}

memory::PortMask CoreTiming::step(std::uint64_t cycle, bool host_requests) {
  return step(cycle, host_requests, [this](const CoreControl::Decision&, memory::PortMask granted) {
    const auto valid = [granted](memory::Port lut, const LaneControl& lane, const Side& side) {
      const SlotCursor& slot = lane.next_slot();
      return has(granted, lut) &&
             (!side.tracks_validity || side.pattern->entry_valid(slot.column(), slot.row()));
    };
    return EntriesRead{valid(memory::Port::kLeftLut, control_.left(), left_),
                       valid(memory::Port::kRightLut, control_.right(), right_)};
  });
}

std::uint64_t CoreTiming::run_ahead(std::uint64_t cycle, std::uint64_t end) {
  while (cycle < end && !control_.frame_done()) {
    step(cycle, false);
    ++cycle;
    if (four_columns_) cycle = skip_known(cycle, end);
  }
  return cycle;
}

// Skips groups whose transitions are recorded. Called after a group of four columns.
std::uint64_t CoreTiming::skip_known(std::uint64_t cycle, std::uint64_t end) {
  // The host may contend for a bank that is uncontended without it.
  if (arbitration_.is_routed(memory::Port::kHost)) return cycle;
  if (known_.is_full()) forget();
  if (stepped_) end_group(cycle);
  if (!has_uniform_slots()) return cycle;
  Progress left = room(cycle, end);
  if (!holds_group(left)) return cycle;
  TransitionCache::Group* group = &known_.at(state(cycle));
  if (group->next != nullptr) {
    Progress skipped;
    group = &known_.walk(*group, left, skipped, control_, arbitration_);
    if (skipped.cycles == 0) return cycle;
    cycle += skipped.cycles;
    left.subtract(skipped);
    control_.count_host(false, false, skipped.cycles);
    control_.skip_to(group->begin->control, skipped.columns, skipped.words);
    arbitration_.skip_to(group->begin->arbitration, cycle, skipped.cycles);
  }
  if (group->next == nullptr && holds_group(left)) begin_group(*group, cycle);
  return cycle;
}

// Whether the slots to be taken next lie in a run of uniform columns. At the beginning of another run the
// cache is cleared.
bool CoreTiming::has_uniform_slots() {
  if (control_.match().draining()) return true;
  const auto is_behind = [](const LaneControl& lane, std::uint64_t uniform_to) {
    return lane.taken() >= uniform_to;
  };
  const LaneControl& left = control_.left();
  const LaneControl& right = control_.right();
  if (left.next_slot().done() || right.next_slot().done()) return false;
  if (is_behind(left, left_uniform_to_) || is_behind(right, right_uniform_to_)) {
    forget();
    left_uniform_to_ = uniform_to(left, left_);
    right_uniform_to_ = uniform_to(right, right_);
  }
  return true;
}

std::uint64_t CoreTiming::uniform_to(const LaneControl& lane, const Side& side) const {
  const AccessPattern& pattern = side.tracks_validity ? *side.pattern : all_valid_;
  return pattern.uniform_until(lane.next_slot().frame_column()) *
         static_cast<std::uint64_t>(control_.geometry().slots_per_column);
}

// How far the core can run before a run of uniform columns ends, or a row of results is complete.
Progress CoreTiming::room(std::uint64_t cycle, std::uint64_t end) const {
  const bool drains = control_.match().draining();
  // A port decides by the slot behind the last one taken: that slot must be in the run too.
  const auto slots = [drains](const LaneControl& lane, std::uint64_t uniform_to) {
    return drains ? 0 : uniform_to - 1 - lane.taken();
  };
  return {end - cycle, control_.match().uniform_columns(), slots(control_.left(), left_uniform_to_),
          slots(control_.right(), right_uniform_to_),
          rows_.next_words() - control_.result().words_written() - 1};
}

// Whether a whole group fits. (A walk that ends with the last uniform column ends at a group whose state is
// not the core's: nothing may be recorded there.)
bool CoreTiming::holds_group(const Progress& room) const {
  const std::uint64_t slots =
      control_.match().draining() ? 0 : 4 * static_cast<std::uint64_t>(control_.geometry().slots_per_column);
  return room.columns >= 4 && room.left_slots >= slots && room.right_slots >= slots;
}

void CoreTiming::begin_group(TransitionCache::Group& group, std::uint64_t cycle) {
  stepped_ = {&group, progress(cycle), control_.counts()};
  arbitration_.begin_recording();
}

// Records the transition. It may have crossed the end of its run of slots: then has_uniform_slots() clears
// the cache at once. If the slots or the matcher's phase have ended, its state does not recur in this frame.
void CoreTiming::end_group(std::uint64_t cycle) {
  TransitionCache::Group& group = *stepped_->group;
  group.progress = progress(cycle);
  group.progress.subtract(stepped_->begin);
  group.counts = CoreControl::difference(control_.counts(), stepped_->counts);
  group.decided = arbitration_.take_recorded();
  group.next = &known_.at(state(cycle));
  stepped_.reset();
}

// Since the frame began, or some other cycle.
Progress CoreTiming::progress(std::uint64_t cycle) const {
  return {cycle, control_.match().columns(), control_.left().taken(), control_.right().taken(),
          control_.result().words_written()};
}

std::uint64_t CoreTiming::earliest_last_write(std::uint64_t cycle) const {
  const std::uint64_t consumes = control_.match().cycles_left();
  // The last word enters the queue with the last of them, and is written in a later cycle.
  if (consumes > 0) return cycle + consumes;
  return cycle + control_.result().words_left() - 1;
}

}  // namespace stereotlm::fpga
