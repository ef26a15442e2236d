#include "models/fpga/transition_cache.h"

#include <algorithm>

namespace stereotlm::fpga {

std::uint64_t Progress::times_in(const Progress& room) const {
  std::uint64_t times = room.cycles / cycles;
  if (columns != 0) times = std::min(times, room.columns / columns);
  if (left_slots != 0) times = std::min(times, room.left_slots / left_slots);
  if (right_slots != 0) times = std::min(times, room.right_slots / right_slots);
  if (words != 0) times = std::min(times, room.words / words);
  return times;
}

void Progress::add(const Progress& other, std::uint64_t times) {
  cycles += other.cycles * times;
  columns += other.columns * times;
  left_slots += other.left_slots * times;
  right_slots += other.right_slots * times;
  words += other.words * times;
}

void Progress::subtract(const Progress& other, std::uint64_t times) {
  cycles -= other.cycles * times;
  columns -= other.columns * times;
  left_slots -= other.left_slots * times;
  right_slots -= other.right_slots * times;
  words -= other.words * times;
}

std::size_t TransitionCache::Hash::operator()(const State& state) const {
  std::uint64_t hash = 0;
  const auto mix = [&hash](std::uint64_t word) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32U;
  };
  for (const LaneControl::State& lane : state.control.lanes) {
    mix(lane.counts);
    mix(lane.marks);
  }
  mix(state.control.rest);
  for (const std::uint64_t word : state.arbitration) mix(word);
  return hash;
}

TransitionCache::Group& TransitionCache::at(const State& state) {
  const auto [entry, is_new] = groups_.try_emplace(state);
  if (is_new) entry->second.begin = &entry->first;
  return entry->second;
}

void TransitionCache::follow(Group& group, std::uint64_t times) {
  if (group.times == 0) walked_.push_back(&group);
  group.times += times;
}

// Loops are found as by Brent (1980): the mark moves to the current group after 1, 2, 4, .. steps, so that a
// loop of any length is found. When the walk returns to the marked group, it repeats the loop as often as
// there is room.
TransitionCache::Group& TransitionCache::walk(Group& first, Progress room, Progress& progress,
                                              CoreControl& control, memory::Arbitration& arbitration) {
  Group* group = &first;
  const Group* mark = group;
  Progress since_mark;
  std::uint64_t steps = 0;
  std::uint64_t mark_after = 1;
  while (group->next != nullptr && group->progress.fits(room)) {
    follow(*group, 1);
    room.subtract(group->progress);
    progress.add(group->progress);
    since_mark.add(group->progress);
    group = group->next;
    ++steps;
    if (group == mark) {
      const std::uint64_t times = since_mark.times_in(room);
      if (times == 0) continue;
      for (std::uint64_t step = 0; step < steps; ++step, group = group->next) follow(*group, times);
      room.subtract(since_mark, times);
      progress.add(since_mark, times);
    } else if (steps == mark_after) {
      mark = group;
      since_mark = {};
      steps = 0;
      mark_after *= 2;
    }
  }
  for (Group* const walked : walked_) {
    control.add(walked->counts, walked->times);
    arbitration.count_skipped(walked->decided, walked->times);
    walked->times = 0;
  }
  walked_.clear();
  return *group;
}

}  // namespace stereotlm::fpga
