#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_stepper.h"

namespace stereotlm::fpga {

// Tells a frame that runs without data which table entries are valid.
//
// An uncontended pixel port takes one cycle for a slot, whether the entry is valid (the port is granted) or
// not (it passes). Only the counts differ. So all entries of such a side are assumed to be valid, and a pass
// counts as a grant, until resolve() corrects the counts. With a rig's tables many more transitions repeat
// then.
class EntryValidity {
 public:
  // `stepper` outlives this object.
  explicit EntryValidity(CoreStepper& stepper);

  // A frame with these accesses starts; the ports are routed. The patterns outlive the frame.
  void start_frame(const AccessPatterns& patterns);
  // A frame starts whose data is moved: its entries are not asked for.
  void start_frame_with_data() { sides_ = {}; }

  // The entries that are read with these grants.
  EntriesRead read(memory::PortMask granted) const {
    return {reads_valid(Side::kLeft, granted), reads_valid(Side::kRight, granted)};
  }
  // The end of the run of uniform columns that begins with the column of the next slot of a side. The
  // columns of AccessPattern::uniform_until().
  std::uint64_t uniform_until(Side side) const;

  // To be called before a route changes, and after the last cycle of a frame. From now on the validity of
  // entries is tracked slot by slot, and the counts are corrected. Returns whether anything was assumed:
  // transitions that were recorded before do not hold any more.
  bool resolve();

 private:
  struct Table {
    const AccessPattern* pattern = nullptr;
    bool is_assumed_valid = false;  // all of its entries
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
