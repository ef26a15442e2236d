#include "models/kernels/sad_columns.h"

#include <algorithm>
#include <cstddef>

#include "models/kernels/limits.h"

namespace stereotlm::kernels {
namespace {

constexpr int kColumnsBetweenMoves = 1024;

}  // namespace

SadColumns::SadColumns(int window, int disparities, const Simd& simd)
    : simd_(simd.column),
      window_(kWindowRule.required("window", window)),
      lanes_(padded_lanes(kDisparitiesRule.required("disparities", disparities))),
      right_histories_(static_cast<std::size_t>(window) *
                       static_cast<std::size_t>(kColumnsBetweenMoves + lanes_)),
      newest_(static_cast<std::size_t>(window)),
      column_sums_(static_cast<std::size_t>(window), LaneArray<std::int16_t>(disparities)),
      window_sums_(disparities) {
  start_frame();
}

void SadColumns::start_frame() {
  std::fill(right_histories_.begin(), right_histories_.end(), std::uint8_t{0});
  for (auto& sums : column_sums_) sums.fill(0);
  window_sums_.fill(0);
  oldest_ = 0;
  position_ = kColumnsBetweenMoves;
}

void SadColumns::push_column(const std::uint8_t* left, const std::uint8_t* right) {
  const std::ptrdiff_t stride = kColumnsBetweenMoves + lanes_;
  std::uint8_t* history = right_histories_.data();
  if (position_ == 0) {
    // A history grows downwards, newest pixel first. At the bottom, the part that is still needed moves to
    // the top.
    for (int row = 0; row < window_; ++row, history += stride) {
      std::copy_n(history, lanes_, history + kColumnsBetweenMoves);
    }
    position_ = kColumnsBetweenMoves;
    history = right_histories_.data();
  }
  --position_;
  for (int row = 0; row < window_; ++row, history += stride) {
    history[position_] = right[row];
    newest_[static_cast<std::size_t>(row)] = history + position_;
  }
  simd_.step_windows(newest_.data(), left, window_, lanes_,
                     column_sums_[static_cast<std::size_t>(oldest_)].data(), window_sums_.data());
  oldest_ = oldest_ + 1 == window_ ? 0 : oldest_ + 1;
}

}  // namespace stereotlm::kernels
