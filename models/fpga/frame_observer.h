#pragma once

#include <cstdint>

namespace stereotlm::fpga {

// The times of a frame of the core.
struct FrameTimes {
  std::uint64_t strobe_ps = 0;    // end of the start strobe
  std::uint64_t first_cycle = 0;  // the first cycle of the frame
  std::uint64_t end_cycle = 0;    // the first cycle after its last write
  std::uint64_t done_cycle = 0;   // the first cycle after the frame; `done` rises as it begins
  std::uint64_t words = 0;        // words written
};

// Receives the frames of a core, for recordings. Plain C++.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  virtual void frame_begun(std::uint64_t strobe_ps) = 0;
  virtual void frame_ended(const FrameTimes& times) = 0;
};

}  // namespace stereotlm::fpga
