#pragma once

#include <cstdint>

#include "models/kernels/gray_image.h"

namespace stereotlm::host {

// The pictures of both cameras, of one size.
struct StereoPair {
  kernels::GrayImage left;   // 8-bit grey
  kernels::GrayImage right;  // 8-bit grey
};

// Supplies the input pictures of a simulation, frame by frame.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  // Returns the input pair of frame number `frame`. It has the configured size and stays valid until the next
  // call.
  virtual const StereoPair& pair(std::uint64_t frame) = 0;
};

// Receives the disparity images from IdealHost, frame by frame.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Called when frame number `frame` ends, at the end of its last cycle.
  virtual void take(std::uint64_t frame, const kernels::GrayImage& disparity) = 0;
};

}  // namespace stereotlm::host
