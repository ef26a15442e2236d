#include "models/fpga/core_control.h"

#include <algorithm>

namespace stereotlm::fpga {

CoreControl::CoreControl(const CoreConfig& config)
    : geometry_(checked(config)),
      has_joint_tables_(config.joint_tables),
      lanes_{LaneControl(geometry_, config.left_table, config.pixel_cache, config.lane_fifo_slots),
             LaneControl(geometry_, config.right_table, config.pixel_cache, config.lane_fifo_slots)},
      match_(geometry_),
      result_(geometry_, config.result_fifo_words) {}

void CoreControl::start_frame(const FrameLatencies& latencies) {
  for (const Side side : kSides) {
    lanes_[index_of(side)].start_frame(latencies[table_port(side)], latencies[pixel_port(side)]);
  }
  match_.start_frame();
  result_.start_frame();
}

void CoreControl::skip_waiting(std::uint64_t cycles) {
  const Decision decision = decide();
  for (std::size_t port = 0; port < kCorePortCount; ++port)
    cycles_[port].add(decision.intents[port], false, cycles);
  count_host(false, false, cycles);
  match_.skip_folds(cycles);
}

void CoreControl::correct_passes(Side side, std::uint64_t cycles) {
  PortCycles& pixel = cycles_[pixel_port(side)];
  pixel.subtract(Intent::kRequest, true, cycles);
  pixel.add(Intent::kPass, false, cycles);
}

CoreControl::Counts CoreControl::counts() const {
  Counts counts;
  std::copy_n(cycles_.begin(), counts.size(), counts.begin());
  return counts;
}

CoreControl::Counts CoreControl::difference(const Counts& after, const Counts& before) {
  Counts difference;
  for (std::size_t port = 0; port < difference.size(); ++port)
    difference[port] = after[port].since(before[port]);
  return difference;
}

void CoreControl::add(const Counts& counts, std::uint64_t times) {
  for (std::size_t port = 0; port < counts.size(); ++port) cycles_[port].add(counts[port], times);
}

void CoreControl::skip_to(memory::StateReader& state, std::uint64_t slots, std::uint64_t words) {
  const std::uint64_t of_lanes = match_.draining() ? 0 : slots;
  for (LaneControl& lane : lanes_) lane.skip_to(*state++, of_lanes);
  match_.skip_to(*state & 0xffff'ffffU, slots);
  result_.skip_to(*state++ >> kHalf, words);
}

std::uint64_t CoreControl::earliest_last_write(std::uint64_t cycle) const {
  // The last words enter the queue together when the matcher has consumed all. They are written later.
  if (const std::uint64_t works = match_.cycles_left(); works > 0)
    return cycle + works + static_cast<std::uint64_t>(geometry_.last_rows) - 1;
  return cycle + result_.words_left() - 1;
}

}  // namespace stereotlm::fpga
