#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"
#include "sw/media/load.h"
#include "sw/media/video.h"

namespace stereotlm::runs {

// The functions of sw/media that the program uses. They are in two libraries, each loaded by the first call
// of one of the functions at the end of this file: loading OpenCV takes 90 ms, and its part for videos
// another 50 ms.

// Functions of load.h and encode.h.
struct MediaFunctions {
  media::LoadedGray (*load_gray)(const std::string& path);
  media::Truth (*load_truth)(const std::string& path, double scale);
  std::vector<std::uint8_t> (*encode_png_gray)(const kernels::GrayImage& image);
  std::vector<std::uint8_t> (*encode_disparity_color_png)(const kernels::GrayImage& disparity,
                                                          int disparities);
  std::vector<std::uint8_t> (*encode_png_16)(int width, int height, const std::vector<std::uint16_t>& values);
  std::vector<std::uint8_t> (*encode_pfm)(const kernels::GrayImage& disparity);
};

// Functions of video.h.
struct VideoFunctions {
  std::unique_ptr<media::Video> (*open_video)(const std::string& path, const media::VideoSizeCheck& check);
};

// Each throws std::runtime_error if its library, which is installed with the program, cannot be loaded.
const MediaFunctions& media_functions();
const VideoFunctions& video_functions();

}  // namespace stereotlm::runs
