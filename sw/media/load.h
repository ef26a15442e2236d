#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Ground truth, referenced to the left picture: disparity = level / scale. It keeps the levels as stored, so
// that comparisons with an integer scale are exact.
struct Truth {
  static constexpr float kUnknown = std::numeric_limits<float>::infinity();

  Truth() = default;
  // Unknown everywhere.
  Truth(int width_pixels, int height_pixels, double of_scale = 1)
      : width(width_pixels),
        height(height_pixels),
        levels(static_cast<std::size_t>(width_pixels) * static_cast<std::size_t>(height_pixels), kUnknown),
        scale(of_scale) {}
  // Level 0 is unknown.
  Truth(const kernels::GrayImage& grey, double of_scale) : Truth(grey.width, grey.height, of_scale) {
    set_levels(grey.pixels);
  }

  // `stored`: levels of a file, as many as there are pixels. Those that are not above 0 or not finite are
  // unknown.
  template <typename Levels>
  void set_levels(const Levels& stored) {
    std::transform(stored.begin(), stored.end(), levels.begin(), [](const auto level) {
      const auto known = static_cast<float>(level);
      return known > 0 && std::isfinite(known) ? known : kUnknown;
    });
  }

  float at(int x, int y) const { return levels[index(x, y)]; }
  float& at(int x, int y) { return levels[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }

  int width = 0;              // pixels
  int height = 0;             // pixels
  std::vector<float> levels;  // row by row
  double scale = 1;           // levels per disparity, > 0
};

// The number of candidate disparities (0, 1, ..) that a board needs to find every known disparity of the
// truth, rounded up. It is a double because a small scale takes it beyond every integer.
inline double disparities_needed(const Truth& truth) {
  float largest = 0;
  for (const float level : truth.levels) {
    if (level != Truth::kUnknown) largest = std::max(largest, level);
  }
  return std::ceil(largest / truth.scale) + 1;
}

// load_gray() reads PNG, JPEG, PGM, PPM and PAM, and by OpenCV BMP, TIFF, WebP, JPEG 2000 and
// Sun raster. The format is detected from the content, not the name. A picture is decoded as stored: an
// orientation is not applied, and opaque alpha is dropped. Each throws one std::runtime_error
// `'path': what was found: rule` for
// - a file that is missing, not regular, too long, empty, truncated, damaged or no picture;
// - a picture larger than the largest image of a board, before its pixels are decoded;
// - transparent pixels, CMYK, 16-bit and float pixels;
// - grey of fewer than 8 bits (PNG of 1, 2, 4 bits; TIFF of 1 bit; PNM with a maximum other than 255), whose
//   levels would have to be stretched, and samples above the maximum.
// While OpenCV decodes, standard error is captured, so no other thread may write there.

// The result of load_gray().
struct LoadedGray {
  kernels::GrayImage image;
  bool converted_from_colour = false;
  std::vector<std::string>
      notes;  // what the user should know of the file: "its orientation 6 is ignored: .."
};

// 8-bit grey as stored. 8-bit colour is converted with OpenCV's BGR2GRAY; any palette counts as colour.
LoadedGray load_gray(const std::string& path);

// Ground truth: a grey picture as above, a grey PNG of 16 bits, or a PFM of one channel, which holds
// disparities (infinite or not above 0: unknown). Without `scale` it is 1, but must be given for 16 bits.
// `content`: of the file, which is then not read; null: it is read. Throws as load_gray() does, and
// std::invalid_argument if `scale` is not positive and finite.
Truth load_truth(const std::string& path, std::optional<double> scale, const std::string* content = nullptr);

// Reads the frames of one video file, in grey: decoded by FFmpeg in software, without the rotation that
// metadata may ask for, and converted with OpenCV's BGR2GRAY. One frame is in memory at a time.
class Video {
 public:
  virtual ~Video() = default;

  // The number of frames that can be decoded, 1 or more.
  virtual std::uint64_t frames() const = 0;
  // The number of frames in the file's header, possibly an estimate; 0 if the header has none.
  virtual std::uint64_t stated_frames() const = 0;

  // Frame `index`, 0 .. frames()-1. The reference is valid until the next call. Decodes the frames from the
  // last requested one up to `index`; for an earlier `index`, opens the file again and decodes from frame 0.
  // Throws std::runtime_error if the file no longer has the frame.
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
