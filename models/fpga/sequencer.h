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
  StreamOut<Slot> left_out{"left_out"};
  // Unbound with joint tables: their reader takes the slots of both sides from left_out.
  sc_core::sc_port<StreamIf<Slot>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> right_out{"right_out"};

  explicit Sequencer(const sc_core::sc_module_name& name) : sc_module(name) {}

  // Sends the slot at this place of the sequence to one side, in the cycle that is `at` from now.
  void issue(Side side, const SlotCursor& place, const sc_core::sc_time& at) {
    ++slots_[index_of(side)];
    const Slot slot = {place.column(), place.row(), place.empty(), at};
    side == Side::kLeft ? left_out->push(slot) : right_out->push(slot);
  }
  // Sends it to the reader of joint tables, for both sides.
  void issue_to_both(const SlotCursor& place, const sc_core::sc_time& at) {
    issue(Side::kLeft, place, at);
    ++slots_[index_of(Side::kRight)];
  }
  // The number of slots that were sent to a side, the empty ones too.
  std::uint64_t slots(Side side) const { return slots_[index_of(side)]; }

 private:
  std::array<std::uint64_t, 2> slots_{};  // [side]
};

}  // namespace stereotlm::fpga
