#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_stepper.h"

namespace stereotlm::fpga {

// The part of FastForward that knows which table entries are valid. While a frame is skipped, it treats all
// entries of a side with an uncontended pixel port as valid, and it corrects the counts afterwards.
//
// An uncontended pixel port takes one cycle for a slot, whether the entry is valid (the port is granted) or
// not (it passes). Only the counts differ: a pass counts as a grant until resolve() corrects the counts. With
// this assumption the transitions of the core repeat far more often with the tables of a rig: a frame of the
// paper's board takes a thirtieth of the time.
class AssumedValidity {
 public:
  // `stepper` outlives this object.
  explicit AssumedValidity(CoreStepper& stepper);

  // To be called when a frame with these accesses starts, after its ports have been routed. The patterns must
  // outlive the frame.
  void start_direct_frame(const AccessPatterns& patterns);
  // To be called when a frame starts whose entries are read by the stages.
  void start_stepped_frame() { sides_ = {}; }

  // The validity of the entries that are read with these grants.
  EntriesRead read(memory::PortMask granted) const {
    return {reads_valid(Side::kLeft, granted), reads_valid(Side::kRight, granted)};
  }
  // The end of the run of uniform columns that begins with the column of the next slot of a side. See
  // AccessPattern::uniform_until().
  std::uint64_t uniform_until(Side side) const;

  // To be called before a route changes, and after the last cycle of a frame. Corrects the counts. From now
  // on the patterns determine which entries are valid. Returns whether an invalid entry may have been taken
  // for valid: if so, transitions that were recorded before are no longer true.
  bool resolve();

 private:
  struct Table {
    const AccessPattern* pattern = nullptr;
    bool is_assumed_valid = false;  // every entry is valid, or assumed to be
  };

  bool resolve(Side side);
  bool reads_valid(Side side, memory::PortMask granted) const {
    if ((granted & memory::mask_of(lut_port(side))) == 0) return false;
    const Table& table = sides_[index_of(side)];
    const SlotCursor& slot = stepper_.control().lane(side).next_slot();
    return table.is_assumed_valid || table.pattern->entry_valid(slot.column(), slot.row());
  }

  CoreStepper& stepper_;
  AccessPattern all_valid_;
  std::array<Table, 2> sides_{};  // [side]
};

}  // namespace stereotlm::fpga
