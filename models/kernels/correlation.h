#pragma once

#include <cstdint>

namespace stereotlm::kernels {

// A score of the cost `zncc` (contract 7.6), without the variance that all candidates of a window have in
// common: covariance * |covariance| / variance, an exact fraction.
struct Correlation {
  std::int64_t covariance = 0;  // its sign is that of the correlation
  std::int64_t variance = 1;    // at least 1. Where a variance is 0 the covariance is 0 too.
};

// Covariances and variances are below 2^34, so that the products have less than 103 bits.
inline bool is_greater(const Correlation& a, const Correlation& b) {
  __extension__ using Wide = __int128;
  const auto numerator = [](const Correlation& value) {
    const Wide covariance = value.covariance;
    return covariance * (covariance < 0 ? -covariance : covariance);
  };
  return numerator(a) * b.variance > numerator(b) * a.variance;
}

// The sums of the pixels of a window, and of their squares.
struct PixelSums {
  std::int64_t pixels = 0;   // the sum of the pixels
  std::int64_t squares = 0;  // the sum of their squares

  // N * squares - pixels^2, for N pixels; 1 instead of 0.
  std::int64_t variance(std::int64_t count) const {
    const std::int64_t variance = count * squares - pixels * pixels;
    return variance == 0 ? 1 : variance;
  }
};

// N * products - pixels * other pixels, for N pixels.
inline std::int64_t covariance(std::int64_t count, std::int64_t products, const PixelSums& a,
                               const PixelSums& b) {
  return count * products - a.pixels * b.pixels;
}

}  // namespace stereotlm::kernels
