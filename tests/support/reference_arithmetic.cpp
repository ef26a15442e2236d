#include "tests/support/reference_arithmetic.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace stereotlm::test {
namespace {

constexpr int kInvalid = -1;
constexpr std::uint8_t kInvalidByte = 255;

// The place of (column, row) in a row-major image.
std::size_t place(int width, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

// floor(numerator / denominator) with denominator > 0; C++ rounds towards zero instead.
std::int64_t floor_of_quotient(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t towards_zero = numerator / denominator;
  const bool inexact = numerator % denominator != 0;
  return inexact && numerator < 0 ? towards_zero - 1 : towards_zero;
}

// The two filtered images and what contract 1.3 says about them.
class Matching {
 public:
  Matching(const ReferenceInput& input, const std::vector<std::uint8_t>& filtered_left,
           const std::vector<std::uint8_t>& filtered_right)
      : width_(input.width),
        height_(input.height),
        radius_((input.window - 1) / 2),
        disparities_(input.disparities),
        filtered_left_(filtered_left),
        filtered_right_(filtered_right) {}

  // argmin over d of SAD(x, y, d).
  int right_based(int x, int y) const {
    return argmin(y, [x](int) { return x; });
  }
  // argmin over d of SAD(x - d, y, d).
  int left_based(int x, int y) const {
    return argmin(y, [x](int d) { return x - d; });
  }

 private:
  template <typename RightPixel>
  int argmin(int y, RightPixel right_pixel) const {
    int best = kInvalid;
    std::int64_t best_sad = 0;
    for (int d = 0; d < disparities_; ++d) {
      if (!is_candidate(right_pixel(d), y, d)) continue;
      const std::int64_t candidate_sad = sad(right_pixel(d), y, d);
      if (best == kInvalid || candidate_sad < best_sad) {  // strictly less: the smallest d wins a tie
        best = d;
        best_sad = candidate_sad;
      }
    }
    return best;
  }

  bool window_inside(int x, int y) const {
    return x - radius_ >= 0 && x + radius_ <= width_ - 1 && y - radius_ >= 0 && y + radius_ <= height_ - 1;
  }
  // Right pixel x meets left pixel x + d; both windows lie wholly inside their images.
  bool is_candidate(int x, int y, int d) const { return window_inside(x, y) && window_inside(x + d, y); }

  std::int64_t sad(int x, int y, int d) const {
    std::int64_t sum = 0;
    for (int j = -radius_; j <= radius_; ++j) {
      for (int i = -radius_; i <= radius_; ++i) {
        const int right = filtered_right_[place(width_, x + i, y + j)];
        const int left = filtered_left_[place(width_, x + i + d, y + j)];
        sum += std::abs(right - left);
      }
    }
    return sum;
  }

  int width_;
  int height_;
  int radius_;
  int disparities_;
  const std::vector<std::uint8_t>& filtered_left_;
  const std::vector<std::uint8_t>& filtered_right_;
};

// Contract 1.4 for one pixel.
std::uint8_t output_pixel(const ReferenceInput& input, const ReferenceResult& result, int x, int y) {
  const std::size_t here = place(input.width, x, y);
  if (input.left_table && ((*input.left_table)[here] >> 31U) == 0) return kInvalidByte;
  const int left_based = result.left_based[here];
  if (left_based == kInvalid) return kInvalidByte;
  if (input.lr_tolerance) {
    const int right_based = result.right_based[place(input.width, x - left_based, y)];
    if (right_based == kInvalid) return kInvalidByte;
    if (std::abs(left_based - right_based) > *input.lr_tolerance) return kInvalidByte;
  }
  return static_cast<std::uint8_t>(left_based);
}

}  // namespace

std::vector<std::uint8_t> reference_rectify(int width, int height, const std::vector<std::uint8_t>& source,
                                            const std::optional<std::vector<std::uint32_t>>& table) {
  if (!table) return source;
  std::vector<std::uint8_t> rectified(source.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const std::uint32_t entry = (*table)[place(width, u, v)];
      const bool valid = (entry >> 31U) == 1;
      const int source_row = static_cast<int>(entry >> 16U & 0x7FFU);
      const int source_column = static_cast<int>(entry & 0x7FFU);
      rectified[place(width, u, v)] =
          valid ? source[place(width, source_column, source_row)] : static_cast<std::uint8_t>(0);
    }
  }
  return rectified;
}

std::vector<std::uint8_t> reference_filter(int width, int height, const std::vector<std::uint8_t>& rectified,
                                           const std::optional<ReferenceKernel>& filter) {
  if (!filter) return rectified;
  const int half = (filter->size - 1) / 2;
  const std::int64_t divisor = std::int64_t{1} << filter->shift;
  std::vector<std::uint8_t> filtered(rectified.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      std::int64_t sum = 0;
      for (int j = -half; j <= half; ++j) {
        for (int i = -half; i <= half; ++i) {
          const std::int64_t weight = filter->weights[place(filter->size, i + half, j + half)];
          const int column = std::clamp(u + i, 0, width - 1);
          const int row = std::clamp(v + j, 0, height - 1);
          sum += weight * rectified[place(width, column, row)];
        }
      }
      const std::int64_t value = 128 + floor_of_quotient(sum, divisor);
      filtered[place(width, u, v)] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(value, 0, 255));
    }
  }
  return filtered;
}

std::vector<std::uint32_t> reference_words(const std::vector<std::uint8_t>& pixels) {
  std::vector<std::uint32_t> words(pixels.size() / 4);
  for (std::size_t word = 0; word < words.size(); ++word) {
    words[word] = static_cast<std::uint32_t>(pixels[4 * word]) |
                  static_cast<std::uint32_t>(pixels[4 * word + 1]) << 8U |
                  static_cast<std::uint32_t>(pixels[4 * word + 2]) << 16U |
                  static_cast<std::uint32_t>(pixels[4 * word + 3]) << 24U;
  }
  return words;
}

ReferenceResult compute_reference(const ReferenceInput& input) {
  const int width = input.width;
  const int height = input.height;

  ReferenceResult result;
  result.rectified_left = reference_rectify(width, height, input.left, input.left_table);
  result.rectified_right = reference_rectify(width, height, input.right, input.right_table);
  result.filtered_left = reference_filter(width, height, result.rectified_left, input.filter);
  result.filtered_right = reference_filter(width, height, result.rectified_right, input.filter);

  const Matching matching(input, result.filtered_left, result.filtered_right);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      result.right_based.push_back(matching.right_based(x, y));
      result.left_based.push_back(matching.left_based(x, y));
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) result.disparity.push_back(output_pixel(input, result, x, y));
  }
  result.disparity_words = reference_words(result.disparity);
  return result;
}

}  // namespace stereotlm::test
