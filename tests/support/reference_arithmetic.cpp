#include "tests/support/reference_arithmetic.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>

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

// Squares of covariances have up to 68 bits.
__extension__ typedef __int128 Wide;

// Exact; the denominator is positive.
struct Fraction {
  Wide numerator = 0;
  Wide denominator = 1;
};

bool operator<(const Fraction& a, const Fraction& b) {
  const auto floor_of = [](const Fraction& value) {
    const Wide towards_zero = value.numerator / value.denominator;
    return value.numerator % value.denominator < 0 ? towards_zero - 1 : towards_zero;
  };
  const Wide floor_a = floor_of(a);
  const Wide floor_b = floor_of(b);
  if (floor_a != floor_b) return floor_a < floor_b;
  const Wide rest_a = a.numerator - floor_a * a.denominator;
  const Wide rest_b = b.numerator - floor_b * b.denominator;
  if (rest_a == 0 || rest_b == 0) return rest_a < rest_b;
  return Fraction{b.denominator, rest_b} <
         Fraction{a.denominator, rest_a};  // the reciprocals of what is left
}

// The two filtered images and what contract 1.3 and 7.6 say about them.
class Matching {
 public:
  Matching(const ReferenceInput& input, const std::vector<std::uint8_t>& filtered_left,
           const std::vector<std::uint8_t>& filtered_right)
      : width_(input.width),
        height_(input.height),
        window_(input.window),
        radius_((input.window - 1) / 2),
        disparities_(input.disparities),
        cost_(input.cost),
        filtered_left_(filtered_left),
        filtered_right_(filtered_right) {
    if (cost_.kind != ReferenceCost::Kind::kCensus) return;
    census_left_ = reference_census(width_, height_, filtered_left, cost_.census_size);
    census_right_ = reference_census(width_, height_, filtered_right, cost_.census_size);
  }

  // With SAD: argmin over d of SAD(x, y, d).
  int right_based(int x, int y) const {
    return best(y, [x](int) { return x; });
  }
  // With SAD: argmin over d of SAD(x - d, y, d).
  int left_based(int x, int y) const {
    return best(y, [x](int d) { return x - d; });
  }

 private:
  template <typename RightPixel>
  int best(int y, RightPixel right_pixel) const {
    int best = kInvalid;
    Fraction best_score;
    for (int d = 0; d < disparities_; ++d) {
      if (!is_candidate(right_pixel(d), y, d)) continue;
      const Fraction candidate = score(right_pixel(d), y, d);
      if (best == kInvalid || is_better(candidate, best_score)) {
        best = d;
        best_score = candidate;
      }
    }
    return best;
  }

  // Equal scores are not better: the smallest d wins a tie.
  bool is_better(const Fraction& candidate, const Fraction& best) const {
    return cost_.kind == ReferenceCost::Kind::kZncc ? best < candidate : candidate < best;
  }

  bool window_inside(int x, int y) const {
    return x - radius_ >= 0 && x + radius_ <= width_ - 1 && y - radius_ >= 0 && y + radius_ <= height_ - 1;
  }
  // Right pixel x meets left pixel x + d; both windows lie wholly inside their images.
  bool is_candidate(int x, int y, int d) const { return window_inside(x, y) && window_inside(x + d, y); }

  // SAD(x, y, d), or the score of another cost function in its place.
  Fraction score(int x, int y, int d) const {
    if (cost_.kind == ReferenceCost::Kind::kZncc) return zncc(x, y, d);
    std::int64_t sum = 0;
    for (int j = -radius_; j <= radius_; ++j) {
      for (int i = -radius_; i <= radius_; ++i) sum += pixel_cost(x + i, y + j, d);
    }
    return {sum, 1};
  }

  std::int64_t pixel_cost(int x, int y, int d) const {
    const std::size_t in_right = place(width_, x, y);
    const std::size_t in_left = place(width_, x + d, y);
    const std::int64_t difference = filtered_right_[in_right] - filtered_left_[in_left];
    if (cost_.kind == ReferenceCost::Kind::kSad) return std::abs(difference);
    if (cost_.kind == ReferenceCost::Kind::kSsd) return difference * difference;
    std::int64_t bits = 0;
    for (int bit = 0; bit < cost_.census_size * cost_.census_size - 1; ++bit) {
      if ((census_right_[in_right] >> bit & 1U) != (census_left_[in_left] >> bit & 1U)) ++bits;
    }
    return bits;
  }

  Fraction zncc(int x, int y, int d) const {
    std::int64_t sum_r = 0;
    std::int64_t sum_l = 0;
    std::int64_t sum_rr = 0;
    std::int64_t sum_ll = 0;
    std::int64_t sum_rl = 0;
    for (int j = -radius_; j <= radius_; ++j) {
      for (int i = -radius_; i <= radius_; ++i) {
        const std::int64_t right = filtered_right_[place(width_, x + i, y + j)];
        const std::int64_t left = filtered_left_[place(width_, x + i + d, y + j)];
        sum_r += right;
        sum_l += left;
        sum_rr += right * right;
        sum_ll += left * left;
        sum_rl += right * left;
      }
    }
    const std::int64_t pixels = std::int64_t{window_} * window_;  // N
    const std::int64_t cov = pixels * sum_rl - sum_r * sum_l;
    const std::int64_t var_r = pixels * sum_rr - sum_r * sum_r;
    const std::int64_t var_l = pixels * sum_ll - sum_l * sum_l;
    if (var_r == 0 || var_l == 0) return {0, 1};
    return {Wide{cov} * std::abs(cov), Wide{var_r} * var_l};
  }

  int width_;
  int height_;
  int window_;
  int radius_;
  int disparities_;
  ReferenceCost cost_;
  const std::vector<std::uint8_t>& filtered_left_;
  const std::vector<std::uint8_t>& filtered_right_;
  std::vector<std::uint64_t> census_left_;  // B, only with kCensus
  std::vector<std::uint64_t> census_right_;
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

// Contract 7.3, one side. The displacement that a valid entry needs:
struct Displacement {
  int x = 0;
  int y = 0;
};
Displacement displacement(int width, std::size_t word, std::uint32_t entry) {
  const int x = static_cast<int>(word) % width;
  const int y = static_cast<int>(word) / width;
  return {static_cast<int>(entry & 0x7FFU) - x, static_cast<int>(entry >> 16U & 0x7FFU) - y};
}

int middle(int least, int greatest) {
  return static_cast<int>(floor_of_quotient(std::int64_t{least} + greatest + 1, 2));
}

ReferenceMiddle middle_of(int width, const std::vector<std::uint32_t>& entries) {
  std::vector<int> needed_x;
  std::vector<int> needed_y;
  for (std::size_t word = 0; word < entries.size(); ++word) {
    if (entries[word] >> 31U == 0) continue;
    needed_x.push_back(displacement(width, word, entries[word]).x);
    needed_y.push_back(displacement(width, word, entries[word]).y);
  }
  if (needed_x.empty()) return {0, 0};
  const auto [least_x, greatest_x] = std::minmax_element(needed_x.begin(), needed_x.end());
  const auto [least_y, greatest_y] = std::minmax_element(needed_y.begin(), needed_y.end());
  return {middle(*least_x, *greatest_x), middle(*least_y, *greatest_y)};
}

// The sixteen bits of a word for one side.
std::uint32_t joint_half(int width, std::size_t word, std::uint32_t entry, const ReferenceMiddle& side) {
  if (entry >> 31U == 0) return 0;
  const Displacement needed = displacement(width, word, entry);
  const int dx = needed.x - side.x;
  const int dy = needed.y - side.y;
  if (dx < -128 || dx > 127 || dy < -64 || dy > 63)
    throw std::invalid_argument("reference_joint_table: a displacement does not fit");
  return 1U << 15U | static_cast<std::uint32_t>(dy + 64) << 8U | static_cast<std::uint32_t>(dx + 128);
}

std::vector<std::uint32_t> separate_entries(int width, const std::vector<std::uint32_t>& words,
                                            unsigned lowest_bit, const ReferenceMiddle& side) {
  std::vector<std::uint32_t> entries;
  for (std::size_t word = 0; word < words.size(); ++word) {
    const std::uint32_t half = words[word] >> lowest_bit & 0xFFFFU;
    const int dy = static_cast<int>(half >> 8U & 0x7FU) - 64;
    const int dx = static_cast<int>(half & 0xFFU) - 128;
    const int column = static_cast<int>(word) % width + dx + side.x;
    const int row = static_cast<int>(word) / width + dy + side.y;
    const bool valid = half >> 15U == 1;
    entries.push_back(
        valid ? 1U << 31U | static_cast<std::uint32_t>(row) << 16U | static_cast<std::uint32_t>(column) : 0);
  }
  return entries;
}

}  // namespace

ReferenceJointTable reference_joint_table(int width, const std::vector<std::uint32_t>& left,
                                          const std::vector<std::uint32_t>& right) {
  ReferenceJointTable table;
  table.left = middle_of(width, left);
  table.right = middle_of(width, right);
  for (std::size_t word = 0; word < left.size(); ++word) {
    table.words.push_back(joint_half(width, word, left[word], table.left) << 16U |
                          joint_half(width, word, right[word], table.right));
  }
  return table;
}

std::vector<std::uint32_t> reference_left_entries(int width, const ReferenceJointTable& table) {
  return separate_entries(width, table.words, 16, table.left);
}

std::vector<std::uint32_t> reference_right_entries(int width, const ReferenceJointTable& table) {
  return separate_entries(width, table.words, 0, table.right);
}

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

std::vector<std::uint64_t> reference_census(int width, int height, const std::vector<std::uint8_t>& filtered,
                                            int census_size) {
  const int half = (census_size - 1) / 2;
  std::vector<std::uint64_t> census(filtered.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      int bit = 0;
      for (int j = -half; j <= half; ++j) {
        for (int i = -half; i <= half; ++i) {
          if (i == 0 && j == 0) continue;
          const int column = std::clamp(u + i, 0, width - 1);
          const int row = std::clamp(v + j, 0, height - 1);
          const bool is_less = filtered[place(width, column, row)] < filtered[place(width, u, v)];
          census[place(width, u, v)] |= std::uint64_t{is_less} << bit++;
        }
      }
    }
  }
  return census;
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
