#pragma once

#include <cstdint>
#include <optional>

namespace stereotlm {

// The whole number nearest to `value`, halves up, if it is certain in spite of the error of `value`. None if
// `value` lies too near to a half or is too large: the caller then computes it exactly, which costs several
// times as much. `value` is not negative, and comes from a few operations with a relative error of 2^-53
// each.
inline std::optional<std::uint64_t> rounded_if_certain(double value) {
  constexpr double kRelativeError = 0x1p-50;
  constexpr double kLargest = 0x1p48;
  if (!(value < kLargest)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(value);
  const double beyond_half = value - static_cast<double>(whole) - 0.5;
  const double error = value * kRelativeError;
  if (beyond_half > error) return static_cast<std::uint64_t>(whole) + 1;
  if (beyond_half < -error) return static_cast<std::uint64_t>(whole);
  return std::nullopt;
}

}  // namespace stereotlm
