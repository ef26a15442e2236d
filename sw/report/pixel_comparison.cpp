#include "sw/report/pixel_comparison.h"

#include <stdexcept>

namespace stereotlm::report {

void PixelComparison::add(std::uint64_t camera_frame, const kernels::GrayImage& a,
                          const kernels::GrayImage& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::invalid_argument("disparities of different sizes have no pixels in common");
  const std::uint64_t before = pixels_;
  for (int row = 0; row < a.height; ++row) {
    for (int column = 0; column < a.width; ++column) {
      const int of_a = a.at(column, row);
      const int of_b = b.at(column, row);
      if (of_a == of_b) continue;
      if (!first_) first_ = First{camera_frame, column, row, of_a, of_b};
      ++pixels_;
    }
  }
  ++frames_;
  if (pixels_ != before) ++frames_that_differ_;
}

}  // namespace stereotlm::report
