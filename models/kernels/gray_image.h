#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stereotlm::kernels {

// An 8-bit grey image, row-major, without padding. Positions are (column, row); (0, 0) is top left.
struct GrayImage {
  int width = 0;                     // pixels
  int height = 0;                    // pixels
  std::vector<std::uint8_t> pixels;  // width * height, row by row from the top

  GrayImage() = default;
  // All pixels are `fill`.
  GrayImage(int width_pixels, int height_pixels, std::uint8_t fill = 0)
      : width(width_pixels),
        height(height_pixels),
        pixels(static_cast<std::size_t>(width_pixels) * static_cast<std::size_t>(height_pixels), fill) {}

  // No range check: 0 <= column < width, 0 <= row < height.
  std::uint8_t at(int column, int row) const { return pixels[index(column, row)]; }
  std::uint8_t& at(int column, int row) { return pixels[index(column, row)]; }

  friend bool operator==(const GrayImage& a, const GrayImage& b) {
    return a.width == b.width && a.height == b.height && a.pixels == b.pixels;
  }
  friend bool operator!=(const GrayImage& a, const GrayImage& b) { return !(a == b); }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

}  // namespace stereotlm::kernels
