#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>

#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/stereo.h"
#include "platform/config/board_config.h"

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

// Pair k is noise of its own, of which the left picture is shifted by `shift` columns.
class NoisePairs : public host::FrameSource {
 public:
  explicit NoisePairs(int width, int height, int shift = 5)
      : shift_(shift), pair_{kernels::GrayImage(width, height), kernels::GrayImage(width, height)} {}

  const host::StereoPair& pair(std::uint64_t number) override {
    if (number == failing_frame) throw std::runtime_error("the disk is gone");
    pair_.left = noise_picture(pair_.left.width, pair_.left.height, number);
    pair_.right = noise_picture(pair_.right.width, pair_.right.height, number, shift_);
    return pair_;
  }
  void set_right_size(int width, int height) { pair_.right = kernels::GrayImage(width, height); }

  std::optional<std::uint64_t> failing_frame;

 private:
  int shift_;
  host::StereoPair pair_;
};

// The disparities of a pair on a board without tables.
inline kernels::GrayImage disparity_of(const host::StereoPair& pair, const platform::BoardConfig& board) {
  const platform::MatcherConfig& matcher = board.matcher;
  return kernels::disparity_image(
      pair.left, pair.right, nullptr, nullptr,
      {matcher.window, matcher.disparities, matcher.filter, matcher.lr_tolerance});
}

}  // namespace stereotlm::test
