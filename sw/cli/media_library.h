#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"
#include "sw/media/load.h"

namespace stereotlm::cli {

// What this program uses of sw/media (load.h, encode.h). It lies in a library that is loaded when it is first
// asked for, because OpenCV's own libraries, which come with it, take 90 ms.
struct MediaFunctions {
  media::LoadedGray (*load_gray)(const std::string& path);
  media::Truth (*load_truth)(const std::string& path, double scale);
  std::vector<std::uint8_t> (*encode_png_gray)(const kernels::GrayImage& image);
  std::vector<std::uint8_t> (*encode_disparity_color_png)(const kernels::GrayImage& disparity,
                                                          int disparities);
  std::vector<std::uint8_t> (*encode_pfm)(const kernels::GrayImage& disparity);
};

// Throws std::runtime_error if the library cannot be loaded; it lies beside the program, as installed.
const MediaFunctions& media_functions();

}  // namespace stereotlm::cli
