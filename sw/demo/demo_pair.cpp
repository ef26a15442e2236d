#include "sw/demo/demo_pair.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stereotlm::demo {
namespace {

using kernels::GrayImage;

std::string size_of(const GrayImage& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

std::uint8_t mean_of_four(const GrayImage& image, int column, int row) {
  const int sum = image.at(column, row) + image.at(column + 1, row) + image.at(column, row + 1) +
                  image.at(column + 1, row + 1);
  return static_cast<std::uint8_t>((sum + 2) / 4);
}

std::uint8_t top_left(const GrayImage& image, int column, int row) { return image.at(column, row); }

GrayImage middle_at_half_size(const GrayImage& full, std::uint8_t (*pixel)(const GrayImage&, int, int)) {
  const int first_column = (full.width / 2 - kWidth) / 2;
  const int first_row = (full.height / 2 - kHeight) / 2;
  GrayImage half(kWidth, kHeight);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      half.at(column, row) = pixel(full, 2 * (first_column + column), 2 * (first_row + row));
    }
  }
  return half;
}

}  // namespace

DemoPair make_demo_pair(const GrayImage& left, const GrayImage& right, const GrayImage& truth) {
  for (const GrayImage* other : {&right, &truth}) {
    if (other->width != left.width || other->height != left.height) {
      throw std::invalid_argument(std::string(other == &right ? "right" : "truth") + " picture = " +
                                  size_of(*other) + ": must be as large as the left one, " + size_of(left));
    }
  }
  if (left.width < 2 * kWidth || left.height < 2 * kHeight) {
    throw std::invalid_argument("left picture = " + size_of(left) + ": must be at least " +
                                size_of(GrayImage(2 * kWidth, 2 * kHeight)));
  }
  return {middle_at_half_size(left, mean_of_four), middle_at_half_size(right, mean_of_four),
          middle_at_half_size(truth, top_left)};
}

}  // namespace stereotlm::demo
