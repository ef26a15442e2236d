#pragma once

#include <cstdint>

#include "models/kernels/gray_image.h"

namespace stereotlm::host {

struct StereoPair {
  kernels::GrayImage left;
  kernels::GrayImage right;
};

// Where the pictures come from and the results go.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  // The pair that frame number `frame` works on, of the configured size; valid until the next call.
  virtual const StereoPair& pair(std::uint64_t frame) = 0;
};

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Frame number `frame` has ended; called at its last cycle's end.
  virtual void take(std::uint64_t frame, const kernels::GrayImage& disparity) = 0;
};

}  // namespace stereotlm::host
