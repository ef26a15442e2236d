#pragma once

#include <cstddef>
#include <cstdint>
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
FilterKernel log7();

// Every broken rule as `field = value: rule`; empty if the kernel is usable.
std::vector<std::string> problems(const FilterKernel& kernel);

}  // namespace stereotlm::kernels
