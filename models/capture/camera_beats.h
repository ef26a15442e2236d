#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_link.h"

// Messages between a camera and its capture board. The first one is VideoFrame: a frame begins now. The camera
// sends its lines only if the receiver sends TakeFrame before the frame's first word is complete.
namespace stereotlm::capture {

// The capture board takes the running frame.
struct TakeFrame {
  std::uint64_t number = 0;
};

// A line of the taken frame begins. Row 0 is sent when the frame is taken. The pixels arrive at the times of
// VideoFrame::timing.
struct VideoLine {
  int row = 0;
  const std::uint8_t* pixels = nullptr;  // the whole line, column 0 first; valid until the next TakeFrame
};

// A camera on demand is to begin a frame after `delay`.
struct Trigger {
  sc_core::sc_time delay{};
};

}  // namespace stereotlm::capture
