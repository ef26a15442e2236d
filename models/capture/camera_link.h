#pragma once

#include <cstdint>

#include "models/capture/camera_timing.h"

// The calls between a camera and its capture board. Plain C++; camera.h has the sockets of the modules.
namespace stereotlm::capture {

// A frame begins, at begin_ps.
struct VideoFrame {
  std::uint64_t number = 0;              // 0 for the camera's first frame
  std::uint64_t begin_ps = 0;            // time of its begin
  const CameraTiming* timing = nullptr;  // timing of its pixels; lives as long as the camera
};

// A capture board, called by its camera.
class FrameReceiver {
 public:
  virtual ~FrameReceiver() = default;
  virtual void begin_frame(const VideoFrame& frame) = 0;  // called when a frame begins
};

// A camera, called by a capture board.
class FrameCamera {
 public:
  virtual ~FrameCamera() = default;
  // The board takes frame `number`, which is the running one. To be called before its first word is complete.
  // Returns false if the camera is in error: then the pixels of the frame never come.
  virtual bool take(std::uint64_t number) = 0;
  // Copies `count` words of the last frame taken, from word `first` on. Word 0 has the frame's first pixels.
  // The pixels of the words must have arrived. The next frame may have begun.
  virtual void copy_words(int first, int count, std::uint32_t* to) const = 0;
  // A camera on demand is to begin a frame at `begin_ps`, now or later.
  virtual void trigger(std::uint64_t begin_ps) = 0;
};

}  // namespace stereotlm::capture
