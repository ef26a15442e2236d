#pragma once

#include <array>
#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/frame_geometry.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Issues the slots of a frame to both lanes, each at its own pace.
class Sequencer : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t slots = 0;
    std::uint64_t empty_slots = 0;  // of these
  };

  StreamOut<Slot> left_out{"left_out"};
  StreamOut<Slot> right_out{"right_out"};

  Sequencer(const sc_core::sc_module_name& name, const FrameGeometry& geometry);

  void start_frame();
  // The next slot of a side, in the cycle at `at` from now.
  void issue(Side side, const sc_core::sc_time& at);
  const Stats& stats(Side side) const { return stats_[static_cast<std::size_t>(side)]; }

 private:
  FrameGeometry geometry_;
  std::array<SlotCursor, 2> cursors_;
  std::array<Stats, 2> stats_{};
};

}  // namespace stereotlm::fpga
