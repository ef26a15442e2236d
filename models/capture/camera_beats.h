#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_timing.h"

// What passes between a camera and its capture board.
namespace stereotlm::capture {

// A frame begins now. The camera sends its lines if the receiver says TakeFrame before the frame's first word
// is complete, and else nothing more of it.
struct VideoFrame {
  std::uint64_t number = 0;  // frames begun before
  std::uint64_t begin_ps = 0;
  const CameraTiming* timing = nullptr;  // of its pixels; lives as long as the camera
};

struct TakeFrame {
  std::uint64_t number = 0;
};

// A line of the frame begins; row 0 may come later, when the frame is taken. Its pixels arrive when
// VideoFrame::timing says so.
struct VideoLine {
  int row = 0;
  const std::uint8_t* pixels =
      nullptr;  // all of the line, lowest column first; valid until the next TakeFrame
};

// To cameras on demand: begin a frame.
struct Trigger {
  sc_core::sc_time delay{};  // from now
};

}  // namespace stereotlm::capture
