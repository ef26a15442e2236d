#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/simd.h"
#include "models/kernels/vector_array.h"

namespace stereotlm::kernels {

// Matches whole rectified image pairs (contract 1.3) with SIMD; used by match() and StereoPipeline. The image
// is cut into bands of rows, and each band into segments of columns; each lane of a vector matches one
// segment of one band (MatchPlan).
class ImageMatcher {
 public:
  // Throws std::invalid_argument outside kWindowRule and kDisparitiesRule.
  ImageMatcher(int width, int height, int window, int disparities, bool right_based,
               const Simd& simd = best_simd());
  ImageMatcher(const ImageMatcher&) = delete;
  ImageMatcher& operator=(const ImageMatcher&) = delete;

  // All arrays have width * height pixels, row-major. Without `right_based`, right_disparity is not written.
  void run(const std::uint8_t* left, const std::uint8_t* right, std::uint8_t* left_disparity,
           std::uint8_t* right_disparity);

 private:
  struct Side {
    VectorArray rows;           // per band: one row, each pixel paired with the pixel that leaves the window
    VectorArray pixel_vectors;  // these pairs of pixels, as one vector per position
    VectorArray best;           // per position: the best keys, then the disparities
    std::vector<std::uint8_t> out;  // per band: one row of disparities
    int positions = 0;
  };

  void choose_bands();
  void prepare(Side& side, int positions, int best_positions);
  void enter_rows(Side& side, const std::uint8_t* image, int step);
  void leave_rows(Side& side, int step, std::uint8_t* disparity);

  int width_;
  int height_;
  int radius_;
  const FrameSimd& simd_;
  MatchPlan plan_;
  int bands_ = 1;     // number of bands, each of band_rows_ rows of windows
  int segments_ = 1;  // segments of a band, each of plan_.columns columns of windows
  int band_rows_ = 0;
  int windows_across_ = 0;
  int windows_down_ = 0;
  std::size_t row_stride_ = 0;  // from one band to the next in Side::rows and Side::out
  Side left_;
  Side right_;
  VectorArray outside_;
  VectorArray band_begins_;
  VectorArray column_sums_;
  std::vector<std::uint8_t> no_row_;  // a row of zeros that stands for the rows above the image
  MatchMemory memory_;
};

}  // namespace stereotlm::kernels
