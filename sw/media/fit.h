#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"
#include "sw/media/load.h"

namespace stereotlm::media {

// The ways to give pictures the size of a board's images (contract, section 1).
inline const std::vector<std::string> kFitNames = {"crop", "pad"};

struct Size {
  int width = 0;   // pixels
  int height = 0;  // pixels

  bool operator==(const Size& other) const { return width == other.width && height == other.height; }
};

inline Size size_of(const kernels::GrayImage& picture) { return {picture.width, picture.height}; }

// How pictures become a board's images.
struct Fit {
  std::string name;              // one of kFitNames; empty: pictures must have the size of the images
  std::optional<Size> image;     // of the board; nullopt if unknown: pictures stay as they are
  bool has_calibration = false;  // with which --fit does not go

  // Throws std::runtime_error, which begins with `named`, if pictures of this size cannot become the images.
  void check(const std::string& named, const Size& picture) const;
  // The end of a message about this size: the options with which a board takes such pictures.
  std::string cure(const Size& picture) const;
  // A picture of a size that is checked, or its truth. Truth is unknown in the padding.
  kernels::GrayImage fitted(const kernels::GrayImage& picture) const;
  Truth fitted(const Truth& truth) const;
};

// The truth for a left table that subtracts this offset from each disparity, and otherwise moves nothing.
Truth with_offset(const Truth& truth, int offset);

}  // namespace stereotlm::media
