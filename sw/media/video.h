#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Reads the frames of one video file, in grey: decoded by FFmpeg in software, without the rotation that
// metadata may ask for, and converted with OpenCV's BGR2GRAY. One frame is in memory at a time.
class Video {
 public:
  virtual ~Video() = default;

  virtual int width() const = 0;   // pixels
  virtual int height() const = 0;  // pixels
  // The number of frames that can be decoded, 1 or more.
  virtual std::uint64_t frames() const = 0;
  // The number of frames in the file's header, possibly an estimate; 0 if the header has none.
  virtual std::uint64_t stated_frames() const = 0;

  // Frame `index`, 0 .. frames()-1. The reference is valid until the next call. Decodes all frames up to
  // `index`; for an earlier frame it opens the file again. Throws std::runtime_error if the file no longer
  // has the frame.
  virtual const kernels::GrayImage& frame(std::uint64_t index) = 0;
};

// Throws if frames of this size, in pixels, cannot be used.
using VideoSizeCheck = std::function<void(int width, int height)>;

// Decodes the whole file once to count its frames. Calls `check` with the size in the file's header, before
// it decodes a frame, and with the size of the frames. Throws one std::runtime_error `'path': what was found:
// rule` for a file that is missing, not regular, no video in a known container or without a frame; for frames
// larger than two images of a board; and if FFmpeg reports a problem. Prints nothing: standard error is
// captured, here and in frame(), so no other thread may write there.
std::unique_ptr<Video> open_video(const std::string& path, const VideoSizeCheck& check);

}  // namespace stereotlm::media
