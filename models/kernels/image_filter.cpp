#include "models/kernels/image_filter.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "models/checked.h"

namespace stereotlm::kernels {

ImageFilter::ImageFilter(int width, int height, const FilterKernel& kernel, const Simd& simd)
    : width_(width), height_(height), half_(kernel.half()), shift_(kernel.shift), simd_(simd) {
  if (width < 1 || height < 1) {
    throw std::invalid_argument("image = " + std::to_string(width) + " x " + std::to_string(height) +
                                ": must have pixels");
  }
  checked(kernel);

  std::int64_t positive = 0;
  for (const int weight : kernel.weights) positive += std::max(weight, 0);
  // The weights sum to 0, so that every sum lies in -255 * positive .. 255 * positive.
  wide_ = positive * 255 > std::numeric_limits<std::int32_t>::max();

  const auto row_array = [&] {
    return VectorArray(static_cast<std::size_t>(width + kernel.size) + kPadding);
  };
  // Pixels of the sums of equal kernel rows, in the order of their weights.
  std::map<int, std::vector<Tap>> pixels;
  std::vector<std::vector<int>> different;  // kernel rows
  for (int row = 0; row < kernel.size; ++row) {
    rows_.push_back(row_array());
    const auto first = kernel.weights.begin() + std::ptrdiff_t{row} * kernel.size;
    const std::vector<int> weights(first, first + kernel.size);
    const auto same = std::find(different.begin(), different.end(), weights);
    const auto index = static_cast<std::size_t>(same - different.begin());
    if (same == different.end()) {
      different.push_back(weights);
      equal_rows_.push_back({{}, row_array(), nullptr});
      for (int column = 0; column < kernel.size; ++column) {
        const int weight = weights[static_cast<std::size_t>(column)];
        if (weight != 0) pixels[weight].push_back({index, column});
      }
    }
    equal_rows_[index].rows.push_back(row - half_);
  }
  for (const auto& [weight, taps] : pixels) add_taps(weight, taps);
  pixels_.resize(taps_.size());
}

void ImageFilter::run(const std::uint8_t* image, std::uint8_t* filtered) {
  int entered = 0;  // rows of the image
  for (int row = 0; row < height_; ++row, filtered += width_) {
    for (; entered < height_ && entered <= row + half_; ++entered)
      enter(image + std::ptrdiff_t{entered} * width_, row_at(entered));
    for (EqualRows& equal : equal_rows_) add_rows(equal, row);
    for (std::size_t i = 0; i < taps_.size(); ++i)
      pixels_[i] = equal_rows_[taps_[i].equal_rows].pixels + taps_[i].column;
    if (wide_) {
      filter_row_wide(filtered);
    } else {
      simd_.filter_row({pairs_.data(), static_cast<int>(pairs_.size()), pixels_.data(), shift_}, width_,
                       filtered);
    }
  }
}

// Adds the taps of one weight, in groups whose pixels sum to 16 bits.
void ImageFilter::add_taps(int weight, const std::vector<Tap>& taps) {
  constexpr std::size_t kMostPixels = std::numeric_limits<std::int16_t>::max() / 255;
  std::size_t pixels = kMostPixels;  // of the group
  for (const Tap& tap : taps) {
    const std::size_t more = equal_rows_[tap.equal_rows].rows.size();
    pixels += more;
    if (pixels > kMostPixels) {
      pixels = more;
      begin_group(static_cast<std::uint32_t>(weight) & 0xFFFFU);
    }
    ++(has_second_ ? pairs_.back().second_count : pairs_.back().first_count);
    taps_.push_back(tap);
  }
}

void ImageFilter::begin_group(std::uint32_t weight) {
  has_second_ = !has_second_;
  if (has_second_) {
    pairs_.back().weights |= static_cast<std::int32_t>(weight << 16U);
  } else {
    pairs_.push_back({static_cast<std::int32_t>(weight), 0, 0});
  }
}

std::int16_t* ImageFilter::row_at(int row) {
  return rows_[static_cast<unsigned>(row) % static_cast<unsigned>(rows_.size())].data();
}

void ImageFilter::enter(const std::uint8_t* pixels, std::int16_t* row) const {
  simd_.widen(pixels, width_, row + half_);
  std::fill_n(row, half_, row[half_]);
  std::fill_n(row + half_ + width_, half_, row[half_ + width_ - 1]);
}

void ImageFilter::add_rows(EqualRows& equal, int row) {
  equal.pixels = nullptr;
  for (const int offset : equal.rows) {
    const std::int16_t* const pixels = row_at(std::clamp(row + offset, 0, height_ - 1));
    if (equal.pixels == nullptr) {
      equal.pixels = pixels;
    } else {
      simd_.add_rows(equal.pixels, pixels, width_ + 2 * half_, equal.sums.data());
      equal.pixels = equal.sums.data();
    }
  }
}

void ImageFilter::filter_row_wide(std::uint8_t* out) const {
  for (int u = 0; u < width_; ++u) {
    std::int64_t sum = 0;
    auto pixels = pixels_.begin();
    const auto add = [&](int weight, int count) {
      for (; count > 0; --count, ++pixels) sum += std::int64_t{weight} * (*pixels)[u];
    };
    for (const WeightPair& pair : pairs_) {
      add(static_cast<std::int16_t>(pair.weights), pair.first_count);
      add(pair.weights >> 16, pair.second_count);
    }
    out[u] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(128 + (sum >> shift_), 0, 255));
  }
}

}  // namespace stereotlm::kernels
