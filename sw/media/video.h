#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// The frames of one video file, in grey: decoded as FFmpeg does (never by hardware, not turned as metadata
// say), then converted with OpenCV's BGR2GRAY. One frame is held at a time.
class Video {
 public:
  virtual ~Video() = default;

  virtual int width() const = 0;   // pixels
  virtual int height() const = 0;  // pixels
  // Those that can be decoded, counted; 1 or more.
  virtual std::uint64_t frames() const = 0;
  // As the file's header says, which may be an estimate; 0 if it does not say.
  virtual std::uint64_t stated_frames() const = 0;

  // index: 0 .. frames()-1. The reference is good until the next call. Decodes the frames that it passes
  // over; to go back it opens the file again. Throws std::runtime_error if the file does not give the frame
  // any more.
  virtual const kernels::GrayImage& frame(std::uint64_t index) = 0;
};

// Throws if frames of this size, in pixels, are of no use.
using VideoSizeCheck = std::function<void(int width, int height)>;

// Decodes the whole file once, to count its frames. Calls `check` with the size that the file's header says,
// before a frame is decoded, and with the size of the frames. Throws one std::runtime_error `'path': what was
// found: rule` for a file that is missing, not regular, no video in a container that is known, whose frames
// are larger than two images of a board, that FFmpeg complains about, or without a frame. Prints nothing: no
// other thread may write to standard error meanwhile (picture and video files alike), nor during frame().
std::unique_ptr<Video> open_video(const std::string& path, const VideoSizeCheck& check);

}  // namespace stereotlm::media
