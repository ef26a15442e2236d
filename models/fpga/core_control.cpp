#include "models/fpga/core_control.h"

#include <algorithm>

namespace stereotlm::fpga {

CoreControl::CoreControl(const CoreConfig& config)
    : geometry_(checked(config)),
      ports_(config),
      has_joint_tables_(config.joint_tables),
      match_(geometry_),
      result_(geometry_, config.result_fifo_words),
      cycles_(ports_.size()) {
  for (const Side side : kSides) {
    for (int lane = 0; lane < config.lanes; ++lane)
      lanes_.emplace_back(geometry_, lane, has_table(config, side), config.pixel_cache,
                          config.lane_fifo_slots);
  }
}

void CoreControl::start_frame(const FrameLatencies& latencies) {
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    lanes_[lane].start_frame(latencies[ports_.group_of(table_port(lane))],
                             latencies[ports_.group_of(pixel_port(lane))]);
  }
  match_.start_frame();
  result_.start_frame();
}

void CoreControl::skip_waiting(std::uint64_t cycles) {
  const Decision decision = decide();
  for (std::size_t port = 0; port < ports_.core_size(); ++port)
    cycles_[port].add(decision.intents[port], false, cycles);
  match_.skip_folds(cycles);
  result_.skip_waiting(cycles);
}

CoreControl::Counts CoreControl::counts() const { return {cycles_.begin(), cycles_.end() - 1}; }

CoreControl::Counts CoreControl::difference(const Counts& after, const Counts& before) {
  Counts difference = after;
  for (std::size_t port = 0; port < difference.size(); ++port)
    difference[port] = after[port].since(before[port]);
  return difference;
}

void CoreControl::add(const Counts& counts, std::uint64_t times) {
  for (std::size_t port = 0; port < counts.size(); ++port) cycles_[port].add(counts[port], times);
}

void CoreControl::set_state(memory::StateReader& state, std::uint64_t consumed, std::uint64_t words) {
  const std::uint64_t before = match_.consumed();
  const std::uint64_t after = std::max(before, std::min(before + consumed, geometry_.consume_cycles));
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    const auto number = static_cast<int>(lane % ports_.lanes());
    lanes_[lane].set_state(
        *state++, geometry_.consumed_slots(number, after) - geometry_.consumed_slots(number, before));
  }
  const std::uint64_t of_both = *state++;
  match_.set_state(of_both & 0xffff'ffffU, consumed);
  result_.set_state(of_both >> kHalf, result_.delay() != 0 ? *state++ : 0, words);
}

std::uint64_t CoreControl::earliest_last_write(std::uint64_t cycle, const Unknown& before) const {
  const auto folds = static_cast<std::uint64_t>(geometry_.folds);
  // On a step that has not ended the matcher has worked for folds - 1 cycles at most.
  const std::uint64_t most_worked = std::min((before.consumed + 1) * folds - 1, before.cycles);
  const std::uint64_t to_write = result_.words_left() - before.words - 1;
  if (match_.cycles_left() <= most_worked) return cycle + to_write;
  // The last words enter the queue together, delay() cycles after the last cycle of the matcher. One is
  // written in each cycle after that.
  const std::uint64_t works =
      match_.cycles_left() - most_worked + static_cast<std::uint64_t>(result_.delay());
  return cycle + std::max(works + static_cast<std::uint64_t>(geometry_.last_rows) - 1, to_write);
}

}  // namespace stereotlm::fpga
