#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/kernels/census.h"
#include "models/kernels/correlation_matcher.h"
#include "models/kernels/matching_cost.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Matches whole rectified and filtered image pairs (contract 1.3, 7.6) with SIMD; used by StereoPipeline. The
// image is cut into bands of rows, and each band into segments of columns; each lane of a vector matches one
// segment of one band (MatchPlan). CorrelationMatcher does the work for the cost `zncc`.
class ImageMatcher {
 public:
  // Throws std::invalid_argument outside kWindowRule and kDisparitiesRule, or if the cost has problems.
  ImageMatcher(int width, int height, int window, int disparities, bool right_based,
               const MatchingCost& cost = {}, const Simd& simd = best_simd());
  ImageMatcher(const ImageMatcher&) = delete;
  ImageMatcher& operator=(const ImageMatcher&) = delete;

  // All arrays have width * height pixels, row-major. Writes the disparities of all pixels that have a
  // window; without `right_based` only those of the left side.
  void run(const std::uint8_t* left, const std::uint8_t* right, std::uint8_t* left_disparity,
           std::uint8_t* right_disparity);

 private:
  struct MatchedImage {
    VectorArray rows;           // per band: one row, each pixel paired with the pixel that leaves the window
    VectorArray pixel_vectors;  // these pairs of pixels, as one vector per position
    VectorArray unpacked;       // MatchSide::unpacked
    VectorArray best;           // per position: the best keys, then the disparities
    std::vector<std::uint8_t> out;  // per band: one row of disparities
    int positions = 0;
    std::optional<CensusTransform> census;
  };

  void choose_loops(const MatchingCost& cost);
  void choose_bands();
  void prepare(MatchedImage& side, int positions, int windows);
  int pixel_stride(const MatchedImage& side) const;
  void enter_rows(MatchedImage& side, const std::uint8_t* image, int step);
  void enter_rows(MatchedImage& side, const std::uint8_t* plane, int step, std::int16_t* pixel_vectors);
  void leave_rows(MatchedImage& side, int step, std::uint8_t* disparity);

  int width_;
  int height_;
  int radius_;
  const Simd& simd_;
  MatchPlan plan_;
  MatchLoops loops_{};
  int pixel_bytes_ = 1;
  int bands_ = 1;     // number of bands, each of band_rows_ rows of windows
  int segments_ = 1;  // segments of a band, each of plan_.columns columns of windows
  int band_rows_ = 0;
  int windows_across_ = 0;
  int windows_down_ = 0;
  std::size_t row_stride_ = 0;  // from one band to the next in MatchedImage::rows and MatchedImage::out
  MatchedImage left_;
  MatchedImage right_;
  VectorArray outside_;
  VectorArray band_begins_;
  VectorArray column_sums_;
  std::vector<std::uint8_t> no_row_;  // a row of zeros that stands for the rows above the image
  MatchMemory memory_;
  std::optional<CorrelationMatcher> correlations_;  // with the cost `zncc`, instead of the loops
};

}  // namespace stereotlm::kernels
