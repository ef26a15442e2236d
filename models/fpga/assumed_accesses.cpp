#include "models/fpga/assumed_accesses.h"

namespace stereotlm::fpga {

void AssumedAccesses::start_direct_frame(const AccessPatterns& patterns) {
  for (const Side side : kSides) {
    const AccessPattern& pattern = patterns[index_of(side)];
    const bool may_be_assumed =
        stepper_.control().lane(side).has_table() && stepper_.arbitration().is_alone(pixel_port(side));
    sides_[index_of(side)] = {&pattern, pattern.needs_all_pixels() || may_be_assumed};
  }
}

std::uint64_t AssumedAccesses::marks(Side side) const {
  const SideAccesses& accesses = sides_[index_of(side)];
  const LaneControl& lane = stepper_.control().lane(side);
  if (!lane.has_table() || lane.handled() == lane.taken()) return 0;
  std::uint64_t marks = 0;
  SlotCursor slot(stepper_.control().geometry());
  slot.advance(lane.handled());
  for (std::uint64_t mark = 1, left = lane.taken() - lane.handled(); left > 0; --left, mark <<= 1U) {
    const bool needs_pixel =
        !slot.empty() && (accesses.are_all || accesses.pattern->needs_pixel(slot.column(), slot.row()));
    if (needs_pixel) marks |= mark;
    slot.advance();
  }
  return marks;
}

void AssumedAccesses::resolve(Side side) {
  const AccessPattern* const pattern = assumed(side);
  if (pattern == nullptr) return;
  sides_[index_of(side)].are_all = false;
  const LaneControl& lane = stepper_.control().lane(side);
  const std::uint64_t passed = pattern->passes_before(lane.handled());
  stepper_.control().correct_passes(side, passed);
  stepper_.control().correct_marks(side, marks(side));
  stepper_.arbitration().retract_grants(pixel_port(side), passed);
}

}  // namespace stereotlm::fpga
