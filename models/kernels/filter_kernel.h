#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::kernels {

inline constexpr IntegerRule kKernelSizeRule{3, 31, 2};        // rows, and columns
inline constexpr IntegerRule kKernelEntryRule{-32768, 32767};  // a weight
inline constexpr IntegerRule kShiftRule{0, 31};                // bits

// An integer convolution kernel of contract 1.2. The filtered image is clamp(128 + floor(S / 2^shift), 0,
// 255), where S is the correlation of the kernel with the image, whose coordinates are clamped to the image.
struct FilterKernel {
  int size = 0;  // m: rows and columns, kKernelSizeRule
  // size * size weights, row by row from the top, each row from the left. Each weight keeps kKernelEntryRule,
  // and their sum is 0.
  std::vector<int> weights;
  int shift = 0;  // kShiftRule

  int half() const { return (size - 1) / 2; }  // h
  int weight(int column, int row) const {      // 0..size-1 each, from the top left
    return weights[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                   static_cast<std::size_t>(column)];
  }
  friend bool operator==(const FilterKernel& a, const FilterKernel& b) {
    return a.size == b.size && a.weights == b.weights && a.shift == b.shift;
  }
};

// The preset `log7`: a Laplacian of Gaussian, 7x7, sigma 1.0, shift 6.
inline FilterKernel log7() {
  return {7,
          {
              0,  -1,  -3,  -5,  -3,  -1,  0,   //
              -1, -6,  -14, -16, -14, -6,  -1,  //
              -3, -14, 0,   35,  0,   -14, -3,  //
              -5, -16, 35,  112, 35,  -16, -5,  //
              -3, -14, 0,   35,  0,   -14, -3,  //
              -1, -6,  -14, -16, -14, -6,  -1,  //
              0,  -1,  -3,  -5,  -3,  -1,  0,
          },
          6};
}

// Every broken rule as `field = value: rule`; empty if the kernel is usable.
inline std::vector<std::string> problems(const FilterKernel& kernel) {
  std::vector<std::string> found;
  kKernelSizeRule.check("kernel size", kernel.size, found);
  const auto expected = static_cast<std::size_t>(kernel.size) * static_cast<std::size_t>(kernel.size);
  if (kernel.size > 0 && kernel.weights.size() != expected) {
    found.push_back("kernel entries = " + std::to_string(kernel.weights.size()) + ": must be " +
                    std::to_string(kernel.size) + " rows of " + std::to_string(kernel.size));
  }
  for (const int weight : kernel.weights) kKernelEntryRule.check("kernel entry", weight, found);
  const auto sum = std::accumulate(kernel.weights.begin(), kernel.weights.end(), std::int64_t{0});
  if (sum != 0) found.push_back("kernel sum = " + std::to_string(sum) + ": must be 0");
  kShiftRule.check("shift", kernel.shift, found);
  return found;
}

}  // namespace stereotlm::kernels
