#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace stereotlm::calib {

// The corners of the pairs in which the grid was found.
struct GridViews {
  GridShape shape;
  int width = 0;  // of a picture, pixels
  int height = 0;
  std::size_t pictures = 0;          // of each camera
  std::vector<std::size_t> numbers;  // of the pictures of `pairs`, in the order of the names, from 0
  std::vector<std::string> names;    // of their files
  std::vector<GridPair> pairs;
};

// A mistake that explains why the pictures of a pair do not belong together, and how to mend it.
struct PictureMistake {
  std::string cause;      // "the pictures of one camera are mirrored"
  std::string cure;       // "mirror them, left to right"
  double rig_rms_px = 0;  // Evidence::rig_rms_px without the mistake
};

// Undoes, one at a time, what people do wrong: pictures of a camera that are turned by 90 or 180 degrees or
// mirrored, names that are shifted by up to three, names in reverse order. A mistake is named only if the rig
// fits without it. The pairs do not fit as they are; the cameras of `rig` are about right.
std::optional<PictureMistake> find_picture_mistake(const GridViews& views, const Rig& rig);

}  // namespace stereotlm::calib
