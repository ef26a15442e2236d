#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/kernels/image_filter.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/simd.h"
#include "models/kernels/stereo.h"

namespace stereotlm::kernels {

// Computes the disparity images of many frames (contract sections 1 and 7.6): rectifies, filters, matches
// and checks whole images. Used by disparity_image() and fpga::DirectFrame. The constructor allocates all
// memory, except for rectified pictures: their memory is allocated with the first table.
class StereoPipeline {
 public:
  // Throws std::invalid_argument if the configuration has problems, or if the images are empty but are to be
  // filtered. `simd`: one of simd_sets().
  StereoPipeline(int width, int height, const StereoConfig& config, const Simd& simd = best_simd());

  // Images hold width * height pixels, tables as many entries, row-major. A null table means that its side
  // has none. Valid entries must point inside the image, which is not checked.
  void run(const std::uint8_t* left, const std::uint8_t* right, const std::uint32_t* left_table,
           const std::uint32_t* right_table, std::uint8_t* disparity);

 private:
  struct Side {
    std::vector<std::uint8_t> rectified;
    std::vector<std::uint8_t> filtered;
    std::vector<std::uint8_t> disparity;  // of the matches based on this side
  };

  const std::uint8_t* prepare(Side& side, const std::uint8_t* image, const std::uint32_t* table);
  void check(const std::uint32_t* left_table, std::uint8_t* disparity) const;

  int width_;
  int height_;
  int radius_;
  std::optional<int> tolerance_;
  const Simd& simd_;
  std::optional<ImageFilter> filter_;
  ImageMatcher matcher_;
  Side left_;
  Side right_;
};

}  // namespace stereotlm::kernels
