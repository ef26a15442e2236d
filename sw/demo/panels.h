#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::demo {

// One picture of a row of pictures.
struct Panel {
  std::string caption;       // drawn smaller if it is wider than the picture
  kernels::GrayImage image;  // not empty
  int levels = 0;  // 0: shown in grey; 1..254: levels 0 .. levels-1 shown in colours, 255 in light grey
  // What the scale of colours says: of level 0, of the last level, and of 255.
  std::string first;
  std::string last;
  std::string missing;
};

// A PNG with the pictures side by side on white, aligned at the top, each below its caption. Those in colours
// (Viridis, from dark to bright) have the scale below them.
std::vector<std::uint8_t> encode_side_by_side_png(const std::vector<Panel>& panels);

}  // namespace stereotlm::demo
