#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_stepper.h"

namespace stereotlm::fpga {

// The part of FastForward that knows which slots access their pixel. While a frame is skipped, it assumes an
// access for every slot of a side with table whose pixel port is uncontended, and it corrects the counts
// afterwards.
//
// An uncontended pixel port takes one cycle for a slot, whether it is granted or passes. Only the counts
// differ: a pass counts as a grant until resolve() corrects the counts. With this assumption the transitions
// of the core repeat far more often with the tables of a rig: a frame of the paper's board takes a thirtieth
// of the time.
class AssumedAccesses {
 public:
  // `stepper` outlives this object.
  explicit AssumedAccesses(CoreStepper& stepper) : stepper_(stepper) {}

  // To be called when a frame with these accesses starts, after its ports have been routed. The patterns must
  // outlive the frame.
  void start_direct_frame(const AccessPatterns& patterns);
  // To be called when a frame starts whose entries are read by the stages.
  void start_stepped_frame() { sides_ = {}; }

  // Whether the slots need their pixels whose entries are read with these grants.
  PixelNeeds needs_pixel(memory::PortMask granted) const {
    return {needs_pixel(Side::kLeft, granted), needs_pixel(Side::kRight, granted)};
  }
  // The pattern by which the accesses of a side vary. Null if all its slots inside the image access their
  // pixels, or are assumed to, or if its port itself finds them in the cache (a side without table).
  const AccessPattern* varying(Side side) const {
    const SideAccesses& accesses = sides_[index_of(side)];
    return accesses.are_all || !stepper_.control().lane(side).has_table() ? nullptr : accesses.pattern;
  }
  // The pattern of a side whose passes are counted as grants until resolve(); null if there are none.
  const AccessPattern* assumed(Side side) const {
    const SideAccesses& accesses = sides_[index_of(side)];
    return accesses.are_all && !accesses.pattern->needs_all_pixels() ? accesses.pattern : nullptr;
  }
  // LaneControl::correct_marks() of a side.
  std::uint64_t marks(Side side) const;

  // To be called before the pixel port of a side ceases to be alone on its bank, and after the last cycle of
  // a frame. Corrects the counts. From now on the pattern determines which slots need their pixels.
  void resolve(Side side);

 private:
  struct SideAccesses {
    const AccessPattern* pattern = nullptr;
    bool are_all = false;  // every slot inside the image has an access, or is assumed to have one
  };

  bool needs_pixel(Side side, memory::PortMask granted) const {
    const CoreControl& control = stepper_.control();
    if ((granted & memory::mask_of(control.table_port(side))) == 0) return false;
    const SideAccesses& accesses = sides_[index_of(side)];
    const SlotCursor& slot = control.lane(side).next_slot();
    return accesses.are_all || accesses.pattern->needs_pixel(slot.column(), slot.row());
  }

  CoreStepper& stepper_;
  std::array<SideAccesses, 2> sides_{};  // [side]
};

}  // namespace stereotlm::fpga
