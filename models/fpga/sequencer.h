#pragma once

#include <array>
#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/frame_geometry.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Sends the slots of a frame to the lanes of both sides, to each at its own pace. The control decides in
// which cycle a lane takes its next slot.
class Sequencer : public sc_core::sc_module {
 public:
  // [lane]: CoreControl::lane_index(). Those of the right side are unbound with joint tables: the readers of
  // the left lanes take the slots of both sides.
  using SlotsOut = sc_core::sc_port<StreamIf<Slot>, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;
  sc_core::sc_vector<SlotsOut> slots_out;

  // `lanes`: on each side.
  Sequencer(const sc_core::sc_module_name& name, std::size_t lanes)
      : sc_module(name), slots_out("slots_out", 2 * lanes), lanes_(lanes) {
    for (SlotsOut& out : slots_out) outs_.push_back(&out);
  }

  // Sends a lane its slot at this place of the sequence, in the cycle that is `at` from now.
  void issue(std::size_t lane, const SlotCursor& place, const sc_core::sc_time& at) {
    ++slots_[lane < lanes_ ? 0 : 1];
    (*outs_[lane])->push({place.column(), place.row(), place.empty(), at});
  }
  // Sends the reader of a joint table its slot for the lanes of both sides. `lane`: that of the left side.
  void issue_to_both(std::size_t lane, const SlotCursor& place, const sc_core::sc_time& at) {
    issue(lane, place, at);
    ++slots_[index_of(Side::kRight)];
  }
  // The number of slots that were sent to a side, the empty ones too.
  std::uint64_t slots(Side side) const { return slots_[index_of(side)]; }

 private:
  std::size_t lanes_;
  std::vector<SlotsOut*> outs_;           // slots_out, whose own access to its elements is slow
  std::array<std::uint64_t, 2> slots_{};  // [side]
};

}  // namespace stereotlm::fpga
