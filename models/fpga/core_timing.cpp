#include "models/fpga/core_timing.h"

#include <algorithm>

namespace stereotlm::fpga {
namespace {

// A longer period is not looked for: what is recorded of it would grow with the frame.
constexpr std::size_t kLongestPeriodCycles = std::size_t{1} << 16U;

constexpr bool has(memory::PortMask mask, memory::Port port) { return (mask & memory::mask_of(port)) != 0; }

}  // namespace

CoreTiming::CoreTiming(const CoreConfig& config, memory::Arbitration& arbitration)
    : control_(config),
      rows_(control_.geometry()),
      arbitration_(arbitration),
      all_valid_(control_.geometry()) {}

void CoreTiming::start_frame(const FrameLatencies& latencies) {
  control_.start_frame(latencies);
  rows_.start_frame(control_);
  left_ = {};
  right_ = {};
  tracking_ = false;
}

void CoreTiming::start_frame(const FrameLatencies& latencies, const SlotPattern& left,
                             const SlotPattern& right) {
  start_frame(latencies);
  // Where no entry is valid the port is never granted, and the bank's round-robin place stays.
  const auto looks = [this](memory::Port port, const SlotPattern& pattern) {
    return !arbitration_.is_alone(port) || pattern.pixel_accesses() == 0;
  };
  left_ = {&left, looks(memory::Port::kLeftPixel, left)};
  right_ = {&right, looks(memory::Port::kRightPixel, right)};
}

void CoreTiming::begin_routing() {
  tracking_ = false;
  look_at_entries();
}

void CoreTiming::look_at_entries() {
  look_at_entries(left_, memory::Port::kLeftPixel, control_.left());
  look_at_entries(right_, memory::Port::kRightPixel, control_.right());
}

// From now on; and what has happened until now is put right.
void CoreTiming::look_at_entries(Side& side, memory::Port port, LaneControl& lane) {
  if (side.looks) return;
  side.looks = true;
  const std::uint64_t passed = side.pattern->invalid_before(lane.handled());
  std::uint64_t marks = 0;
  for (std::uint64_t slot = lane.handled(); slot < lane.taken(); ++slot)
    marks |= std::uint64_t{side.pattern->needs_pixel(slot)} << (slot - lane.handled());
  lane.correct_passes(passed, marks);
  arbitration_.take_back(port, passed);
}

memory::PortMask CoreTiming::step(std::uint64_t cycle, bool host_requests) {
  return step(cycle, host_requests, [this](const CoreControl::Decision& decision, memory::PortMask granted) {
    if (tracking_) period_.push_back({decision, granted});
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
    if (four_columns_) cycle = repeat(cycle, end);
  }
  return cycle;
}

// After four columns. The beginning moves on after 1, 2, 4, .. groups of them (Brent, 1980), so that a period of any
// length is found once nothing disturbs it any more.
std::uint64_t CoreTiming::repeat(std::uint64_t cycle, std::uint64_t end) {
  const State state{control_.state(), arbitration_.state(cycle)};
  const bool drains = control_.match().draining();
  const bool undisturbed = tracking_ && control_.match().state() == beginning_.phase &&
                           (drains || (control_.left().taken() < beginning_.left_alike_to &&
                                       control_.right().taken() < beginning_.right_alike_to));
  if (!undisturbed || period_.size() > kLongestPeriodCycles) {
    patience_ = 1;
    begin_period(state, cycle);
    return cycle;
  }
  if (!(state == beginning_.state)) {
    if (++groups_ == patience_) {
      patience_ *= 2;
      begin_period(state, cycle);
    }
    return cycle;
  }
  const std::uint64_t cycles = cycle - beginning_.cycle;
  const std::uint64_t columns = control_.match().columns() - beginning_.columns;
  const std::uint64_t times = std::min((end - cycle) / cycles, times_alike(columns));
  if (times > 0) {
    arbitration_.repeat(cycles, times);
    for (const Cycle& past : period_) control_.count(past.decision, past.granted, times);
    control_.count_host(false, false, cycles * times);
    control_.skip_columns(columns * times);
    cycle += cycles * times;
  }
  patience_ = 1;
  begin_period(state, cycle);
  return cycle;
}

void CoreTiming::begin_period(const State& state, std::uint64_t cycle) {
  tracking_ = true;
  groups_ = 0;
  period_.clear();
  arbitration_.begin_period();
  beginning_ = {state,
                cycle,
                control_.match().state(),
                control_.match().columns(),
                alike_to(control_.left(), left_),
                alike_to(control_.right(), right_)};
}

std::uint64_t CoreTiming::alike_to(const LaneControl& lane, const Side& side) const {
  if (lane.next_slot().done()) return lane.taken();
  const SlotPattern& pattern = side.looks ? *side.pattern : all_valid_;
  return pattern.alike_until(lane.next_slot().frame_column()) *
         static_cast<std::uint64_t>(control_.geometry().slots_per_column);
}

// How often the last columns can come again before something is different, or a row of results is whole.
std::uint64_t CoreTiming::times_alike(std::uint64_t columns) const {
  const MatchControl& match = control_.match();
  std::uint64_t times = match.columns_alike() / columns;
  if (match.word_leaves())
    times = std::min(times, (rows_.next_words() - control_.result().words_written() - 1) / (columns / 4));
  if (match.draining()) return times;
  const std::uint64_t slots = columns * static_cast<std::uint64_t>(control_.geometry().slots_per_column);
  // The slot behind the last one taken counts too: a port decides by it.
  const auto times_of = [slots](std::uint64_t alike_to, const LaneControl& lane) {
    return (alike_to - 1 - lane.taken()) / slots;
  };
  return std::min({times, times_of(beginning_.left_alike_to, control_.left()),
                   times_of(beginning_.right_alike_to, control_.right())});
}

std::uint64_t CoreTiming::earliest_last_write(std::uint64_t cycle) const {
  const std::uint64_t consumes = control_.match().cycles_left();
  // The last word enters the queue with the last of them, and is written in a later cycle.
  if (consumes > 0) return cycle + consumes;
  return cycle + control_.result().words_left() - 1;
}

}  // namespace stereotlm::fpga
