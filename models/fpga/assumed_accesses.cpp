#include "models/fpga/assumed_accesses.h"

namespace stereotlm::fpga {

AssumedAccesses::AssumedAccesses(CoreStepper& stepper)
    : stepper_(stepper), all_(stepper.control().geometry(), PixelCache::kNone) {}

void AssumedAccesses::start_direct_frame(const AccessPatterns& patterns) {
  for (const Side side : kSides) {
    const AccessPattern& pattern = patterns[index_of(side)];
    const bool may_be_assumed =
        stepper_.control().lane(side).has_table() && stepper_.arbitration().is_alone(pixel_port(side));
    sides_[index_of(side)] = {&pattern, pattern.needs_all_pixels() || may_be_assumed};
  }
}

std::uint64_t AssumedAccesses::uniform_until(Side side) const {
  const SideAccesses& accesses = sides_[index_of(side)];
  const AccessPattern& pattern = accesses.are_all ? all_ : *accesses.pattern;
  return pattern.uniform_until(stepper_.control().lane(side).next_slot().frame_column());
}

bool AssumedAccesses::resolve() {
  const bool left_may_be_wrong = resolve(Side::kLeft);
  const bool right_may_be_wrong = resolve(Side::kRight);
  return left_may_be_wrong || right_may_be_wrong;
}

bool AssumedAccesses::resolve(Side side) {
  SideAccesses& accesses = sides_[index_of(side)];
  if (!accesses.are_all || accesses.pattern->needs_all_pixels()) return false;
  accesses.are_all = false;
  const LaneControl& lane = stepper_.control().lane(side);
  const std::uint64_t passed = accesses.pattern->passes_before(lane.handled());
  std::uint64_t marks = 0;
  for (std::uint64_t slot = lane.handled(); slot < lane.taken(); ++slot)
    marks |= std::uint64_t{accesses.pattern->needs_pixel(slot)} << (slot - lane.handled());
  stepper_.control().correct_passes(side, passed, marks);
  stepper_.arbitration().retract_grants(pixel_port(side), passed);
  return true;
}

}  // namespace stereotlm::fpga
