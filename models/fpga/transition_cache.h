#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// The progress of the core over some cycles of a frame, or a limit for that progress.
struct Progress {
  std::uint64_t cycles = 0;
  std::uint64_t columns = 0;      // consumed by the matcher
  std::uint64_t left_slots = 0;   // taken by the left lane
  std::uint64_t right_slots = 0;  // taken by the right lane
  std::uint64_t words = 0;        // results written

  bool fits(const Progress& room) const {
    return cycles <= room.cycles && columns <= room.columns && left_slots <= room.left_slots &&
           right_slots <= room.right_slots && words <= room.words;
  }
  // How many times this progress fits into the limit `room`. `cycles` must not be 0.
  std::uint64_t times_in(const Progress& room) const;
  void add(const Progress& other, std::uint64_t times = 1);
  void subtract(const Progress& other, std::uint64_t times = 1);
};

// Memo of state transitions for FastForward, one per group of four columns of the matcher. The state of the
// control objects and the arbiters before a group determines the group's cycles, counts and next state, as
// long as the slots to come make the same accesses. A transition is recorded when its group is stepped; after
// that it is skipped. The caller clears the memo where the accesses of the slots or the routes of the ports
// change.
class TransitionCache {
 public:
  // Cap: a frame that never repeats would otherwise fill memory.
  static constexpr std::size_t kMost = 4096;

  struct State {
    CoreControl::State control;
    memory::Arbitration::State arbitration{};

    friend bool operator==(const State& a, const State& b) {
      return a.control == b.control && a.arbitration == b.arbitration;
    }
  };
  struct Group {
    const State* begin = nullptr;
    Group* next = nullptr;  // group that follows; null until the transition is recorded
    Progress progress;
    CoreControl::Counts counts{};
    memory::Arbitration::Decided decided;
    std::uint64_t times = 0;  // how often walk() has followed the transition, not counted yet
  };

  explicit TransitionCache(std::size_t most = kMost) : most_(most) {}
  TransitionCache(const TransitionCache&) = delete;  // groups point to each other
  TransitionCache& operator=(const TransitionCache&) = delete;

  // Returns the group that begins in a state, which is added if there is none. References stay valid until
  // clear().
  Group& at(const State& state);
  void clear() { groups_.clear(); }
  bool is_full() const { return groups_.size() >= most_; }

  // Follows the recorded transitions from a group as far as there is room. A loop of transitions is repeated
  // in one step. Adds the progress made to `progress`, and the counts to `control` and `arbitration`. Returns
  // the group that comes next. The caller must set `control` and `arbitration` to its state.
  Group& walk(Group& first, Progress room, Progress& progress, CoreControl& control,
              memory::Arbitration& arbitration);

 private:
  struct Hash {
    std::size_t operator()(const State& state) const;
  };

  void follow(Group& group, std::uint64_t times);

  std::size_t most_;
  std::unordered_map<State, Group, Hash> groups_;
  std::vector<Group*> walked_;  // groups whose `times` is not 0
};

}  // namespace stereotlm::fpga
