#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// How far the core comes in some cycles, or may come.
struct Progress {
  std::uint64_t cycles = 0;
  std::uint64_t columns = 0;      // of the matcher
  std::uint64_t left_slots = 0;   // taken
  std::uint64_t right_slots = 0;  // taken
  std::uint64_t words = 0;        // of results written

  bool fits(const Progress& room) const {
    return cycles <= room.cycles && columns <= room.columns && left_slots <= room.left_slots &&
           right_slots <= room.right_slots && words <= room.words;
  }
  // How often; `cycles` is not 0.
  std::uint64_t times_in(const Progress& room) const;
  void add(const Progress& other, std::uint64_t times = 1);
  void subtract(const Progress& other, std::uint64_t times = 1) { add(other, ~times + 1); }
};

// What the core does from one group of four columns of the matcher to the next, by the state that it begins
// in: noted when it is stepped, and from then on skipped. The state says it all as long as the slots to come
// make the same accesses; the groups of another stretch of slots, or of other routes, are others.
class KnownGroups {
 public:
  // Of what never comes again as much would be noted as the frame is long.
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
    Group* next = nullptr;  // none while it is not known what the group does
    Progress progress;
    CoreControl::Counts counts{};
    memory::Arbitration::Decided decided;
    std::uint64_t times = 0;  // that it has come in walk() and is not counted yet
  };

  explicit KnownGroups(std::size_t most = kMost) : most_(most) {}
  KnownGroups(const KnownGroups&) = delete;  // groups point to each other
  KnownGroups& operator=(const KnownGroups&) = delete;

  // The group that begins in a state. Groups stay until clear().
  Group& at(const State& state);
  void clear() { groups_.clear(); }
  bool is_full() const { return groups_.size() >= most_; }

  // Follows what is known from a group on, as far as there is room, and around rings at once. Adds what has
  // come to `progress`, and to the counts of control and arbitration, whose states the caller brings to that
  // of the group returned, which comes next.
  Group& walk(Group& first, Progress room, Progress& progress, CoreControl& control,
              memory::Arbitration& arbitration);

 private:
  struct Hash {
    std::size_t operator()(const State& state) const;
  };

  void note(Group& group, std::uint64_t times);

  std::size_t most_;
  std::unordered_map<State, Group, Hash> groups_;
  std::vector<Group*> walked_;  // not counted yet
};

}  // namespace stereotlm::fpga
