#pragma once

#include <cstdint>

#include "models/kernels/gray_image.h"

namespace stereotlm::test {

// A picture of noise. `number` selects the noise, `shift` moves it to the left by so many columns.
inline kernels::GrayImage noise_picture(int width, int height, std::uint64_t number, int shift = 0) {
  kernels::GrayImage picture(width, height);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const auto place = static_cast<std::uint32_t>(row * 4096 + column + shift);
      const std::uint32_t mixed = (place + static_cast<std::uint32_t>(number) * 77'777U) * 2'654'435'761U;
      picture.at(column, row) = static_cast<std::uint8_t>(mixed >> 24U);
    }
  }
  return picture;
}

}  // namespace stereotlm::test
