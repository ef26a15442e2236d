#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "models/kernels/words.h"

namespace stereotlm::kernels {

// Returns whether the left-based disparity of a left pixel survives (contract 1.4). `right_based`: that of
// the right pixel that it points to. Without a tolerance (`off`) every valid disparity survives.
inline bool left_right_consistent(std::uint8_t left_based, std::uint8_t right_based,
                                  std::optional<int> tolerance) {
  if (left_based == kInvalidDisparity) return false;
  if (!tolerance) return true;
  return right_based != kInvalidDisparity && std::abs(int{left_based} - int{right_based}) <= *tolerance;
}

// The left-right check behind the select-min units, column by column; used by fpga::LrCheck. The right-based
// result of a column (unit A) comes disparities-1 columns after its left-based result (unit B), which waits
// for it.
class LrCheck {
 public:
  // `disparities`: D. `tolerance`: nullopt for `off`.
  LrCheck(int disparities, std::optional<int> tolerance)
      : delay_(static_cast<std::uint64_t>(disparities - 1)), tolerance_(tolerance) {}

  void start_frame() { time_ = 0; }  // to be called before the first column of a frame

  // Steps one column. `left_based`: unit B's disparity of its left pixel. `left_valid`: whether the table
  // entry of that pixel is valid. `right_based`: unit A's disparity of the right pixel D-1 columns back.
  // Returns the disparity of the left pixel D-1 columns back, or kInvalidDisparity if it fails the check.
  std::uint8_t step(std::uint8_t left_based, bool left_valid, std::uint8_t right_based) {
    const std::uint64_t now = time_++;
    left_[now % kRing] = left_valid ? left_based : kInvalidDisparity;
    right_[now % kRing] = right_based;
    if (now < delay_) return kInvalidDisparity;
    const std::uint8_t d = left_[(now - delay_) % kRing];
    // Right pixel x - d was d columns before right pixel x, which is the newest.
    return left_right_consistent(d, right_[(now - d) % kRing], tolerance_) ? d : kInvalidDisparity;
  }

 private:
  static constexpr std::uint64_t kRing = 256;  // at least the largest disparity + 1
  std::uint64_t delay_;
  std::optional<int> tolerance_;
  std::uint64_t time_ = 0;
  std::array<std::uint8_t, kRing> left_{};
  std::array<std::uint8_t, kRing> right_{};
};

}  // namespace stereotlm::kernels
