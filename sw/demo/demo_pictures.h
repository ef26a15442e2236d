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

inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
// Grey levels per disparity of DemoPair::truth. The full-size truth has one; at half size disparities halve.
inline constexpr int kTruthScale = 2;

// A stereo pair with ground truth, in the size of the board fpl2003.
struct DemoPair {
  kernels::GrayImage left;
  kernels::GrayImage right;
  kernels::GrayImage truth;  // grey / kTruthScale = disparity, 0 = unknown
};

// Scales a full-size pair and its truth (grey = disparity, 0 = unknown) to half size and crops all three to
// the same central kWidth x kHeight, which does not change disparities. A pixel of a picture is the mean of
// 2x2 pixels (halves up). A pixel of the truth is the top left one of them, because the mean over an edge is
// the depth of neither side. Throws std::invalid_argument if the sizes differ or are below 2 * kWidth x 2 *
// kHeight.
DemoPair make_demo_pair(const kernels::GrayImage& left, const kernels::GrayImage& right,
                        const kernels::GrayImage& truth);

}  // namespace stereotlm::demo
