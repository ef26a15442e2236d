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

void CoreTiming::start_frame(const FrameLatencies& latencies, const SlotPattern& left,
                             const SlotPattern& right) {
  start_frame(latencies);
  left_ = {&left, !arbitration_.is_alone(memory::Port::kLeftPixel)};
  right_ = {&right, !arbitration_.is_alone(memory::Port::kRightPixel)};
}

void CoreTiming::host_route_changes() {
  stepped_.reset();
  look_at_entries();
}

void CoreTiming::forget() {
  stepped_.reset();
  known_.clear();
  left_alike_to_ = 0;
  right_alike_to_ = 0;
}

void CoreTiming::look_at_entries() {
  look_at_entries(left_, memory::Port::kLeftPixel, control_.left());
  look_at_entries(right_, memory::Port::kRightPixel, control_.right());
}

// From now on; and what has happened until now is put right.
void CoreTiming::look_at_entries(Side& side, memory::Port port, LaneControl& lane) {
  if (side.looks) return;
  side.looks = true;
  forget();
  const std::uint64_t passed = side.pattern->invalid_before(lane.handled());
  std::uint64_t marks = 0;
  for (std::uint64_t slot = lane.handled(); slot < lane.taken(); ++slot)
    marks |= std::uint64_t{side.pattern->needs_pixel(slot)} << (slot - lane.handled());
  lane.correct_passes(passed, marks);
  arbitration_.take_back(port, passed);
}

memory::PortMask CoreTiming::step(std::uint64_t cycle, bool host_requests) {
  return step(cycle, host_requests, [this](const CoreControl::Decision&, memory::PortMask granted) {
    const auto valid = [granted](memory::Port lut, const LaneControl& lane, const Side& side) {
      const SlotCursor& slot = lane.next_slot();
      return has(granted, lut) && (!side.looks || side.pattern->entry_valid(slot.column(), slot.row()));
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

// After four columns.
std::uint64_t CoreTiming::skip_known(std::uint64_t cycle, std::uint64_t end) {
  // The route of the host may make another bank a shared one.
  if (arbitration_.is_routed(memory::Port::kHost)) return cycle;
  if (known_.is_full()) forget();
  if (stepped_) end_group(cycle);
  if (!look_at_slots()) return cycle;
  Progress left = room(cycle, end);
  if (!holds_group(left)) return cycle;
  KnownGroups::Group* group = &known_.at(state(cycle));
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

// Whether the slots next to be taken are known to make the same accesses for a while. Where another stretch
// of them begins, no group is known any more.
bool CoreTiming::look_at_slots() {
  if (control_.match().draining()) return true;
  const auto is_behind = [](const LaneControl& lane, std::uint64_t alike_to) {
    return lane.taken() >= alike_to;
  };
  const LaneControl& left = control_.left();
  const LaneControl& right = control_.right();
  if (left.next_slot().done() || right.next_slot().done()) return false;
  if (is_behind(left, left_alike_to_) || is_behind(right, right_alike_to_)) {
    forget();
    left_alike_to_ = alike_to(left, left_);
    right_alike_to_ = alike_to(right, right_);
  }
  return true;
}

std::uint64_t CoreTiming::alike_to(const LaneControl& lane, const Side& side) const {
  const SlotPattern& pattern = side.looks ? *side.pattern : all_valid_;
  return pattern.alike_until(lane.next_slot().frame_column()) *
         static_cast<std::uint64_t>(control_.geometry().slots_per_column);
}

// How far the core can come before something is different, or a row of results is whole.
Progress CoreTiming::room(std::uint64_t cycle, std::uint64_t end) const {
  const bool drains = control_.match().draining();
  // The slot behind the last one taken counts too: a port decides by it.
  const auto slots = [drains](const LaneControl& lane, std::uint64_t alike_to) {
    return drains ? 0 : alike_to - 1 - lane.taken();
  };
  return {end - cycle, control_.match().columns_alike(), slots(control_.left(), left_alike_to_),
          slots(control_.right(), right_alike_to_),
          rows_.next_words() - control_.result().words_written() - 1};
}

// Whether four columns may be alike. (Behind the last column alike a walk has ended at the group of a state
// that is not the core's: nothing may be noted there.)
bool CoreTiming::holds_group(const Progress& room) const {
  const std::uint64_t slots =
      control_.match().draining() ? 0 : 4 * static_cast<std::uint64_t>(control_.geometry().slots_per_column);
  return room.columns >= 4 && room.left_slots >= slots && room.right_slots >= slots;
}

void CoreTiming::begin_group(KnownGroups::Group& group, std::uint64_t cycle) {
  stepped_ = {&group, progress(cycle), control_.counts()};
  arbitration_.begin_recording();
}

// It is known now. Something may have become different on the way: of other slots look_at_slots() forgets it
// at once; behind the last slot, and behind another state of the matcher, its own state does not come again
// in this frame.
void CoreTiming::end_group(std::uint64_t cycle) {
  KnownGroups::Group& group = *stepped_->group;
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
