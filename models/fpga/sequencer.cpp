#include "models/fpga/sequencer.h"

namespace stereotlm::fpga {

Sequencer::Sequencer(const sc_core::sc_module_name& name, const FrameGeometry& geometry)
    : sc_module(name), geometry_(geometry) {}

void Sequencer::start_frame() { cursors_.fill(SlotCursor(geometry_)); }

void Sequencer::issue(Side side, const sc_core::sc_time& at) {
  SlotCursor& cursor = cursors_[static_cast<std::size_t>(side)];
  Stats& stats = stats_[static_cast<std::size_t>(side)];
  const Slot slot{cursor.column(), cursor.row(), cursor.empty(), at};
  cursor.advance();
  ++stats.slots;
  stats.empty_slots += std::uint64_t{slot.empty};
  (side == Side::kLeft ? left_out : right_out)->push(slot);
}

}  // namespace stereotlm::fpga
