#pragma once

#include <array>
#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/frame_geometry.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Sends the slots of a frame to both lanes, each at its own pace. The control decides in which cycle a lane
// takes its next slot.
class Sequencer : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t slots = 0;
    std::uint64_t empty_slots = 0;  // also counted in `slots`
  };

  StreamOut<Slot> left_out{"left_out"};
  // Unbound with joint tables: their reader takes the slots of both sides from left_out.
  sc_core::sc_port<StreamIf<Slot>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> right_out{"right_out"};

  explicit Sequencer(const sc_core::sc_module_name& name) : sc_module(name) {}

  // Sends the slot at this place of the sequence to one side, in the cycle that is `at` from now.
  void issue(Side side, const SlotCursor& place, const sc_core::sc_time& at) {
    Stats& stats = stats_[static_cast<std::size_t>(side)];
    ++stats.slots;
    stats.empty_slots += std::uint64_t{place.empty()};
    const Slot slot = {place.column(), place.row(), place.empty(), at};
    side == Side::kLeft ? left_out->push(slot) : right_out->push(slot);
  }
  // Sends it to the reader of joint tables, for both sides.
  void issue_to_both(const SlotCursor& place, const sc_core::sc_time& at) {
    issue(Side::kLeft, place, at);
    count(Side::kRight, {1, std::uint64_t{place.empty()}});
  }
  // Adds the counts of a frame whose slots were not sent.
  void count(Side side, const Stats& frame) {
    Stats& stats = stats_[static_cast<std::size_t>(side)];
    stats.slots += frame.slots;
    stats.empty_slots += frame.empty_slots;
  }
  const Stats& stats(Side side) const { return stats_[static_cast<std::size_t>(side)]; }

 private:
  std::array<Stats, 2> stats_{};
};

}  // namespace stereotlm::fpga
