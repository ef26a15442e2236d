#include "models/fpga/assumed_validity.h"

namespace stereotlm::fpga {

AssumedValidity::AssumedValidity(CoreStepper& stepper)
    : stepper_(stepper), all_valid_(stepper.control().geometry()) {}

void AssumedValidity::start_direct_frame(const AccessPatterns& patterns) {
  for (const Side side : kSides) {
    const AccessPattern& pattern = patterns[index_of(side)];
    const bool is_uncontended = stepper_.arbitration().is_alone(pixel_port(side));
    sides_[index_of(side)] = {&pattern, pattern.all_valid() || is_uncontended};
  }
}

std::uint64_t AssumedValidity::uniform_until(Side side) const {
  const Table& table = sides_[index_of(side)];
  const AccessPattern& pattern = table.is_assumed_valid ? all_valid_ : *table.pattern;
  return pattern.uniform_until(stepper_.control().lane(side).next_slot().frame_column());
}

bool AssumedValidity::resolve() {
  const bool left_may_be_wrong = resolve(Side::kLeft);
  const bool right_may_be_wrong = resolve(Side::kRight);
  return left_may_be_wrong || right_may_be_wrong;
}

bool AssumedValidity::resolve(Side side) {
  Table& table = sides_[index_of(side)];
  if (!table.is_assumed_valid || table.pattern->all_valid()) return false;
  table.is_assumed_valid = false;
  const LaneControl& lane = stepper_.control().lane(side);
  const std::uint64_t passed = table.pattern->invalid_before(lane.handled());
  std::uint64_t marks = 0;
  for (std::uint64_t slot = lane.handled(); slot < lane.taken(); ++slot)
    marks |= std::uint64_t{table.pattern->needs_pixel(slot)} << (slot - lane.handled());
  stepper_.control().correct_passes(side, passed, marks);
  stepper_.arbitration().retract_grants(pixel_port(side), passed);
  return true;
}

}  // namespace stereotlm::fpga
