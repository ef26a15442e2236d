#pragma once

#include <cstdint>
#include <optional>

namespace stereotlm {

// Returns the whole number nearest to `value`, halves up, if the rounding errors in `value` cannot change it.
// Returns nothing if `value` lies too near to a half or is too large: the caller must then compute the number
// exactly, which takes several times as long. `value` must not be negative, and must be the result of a few
// operations with a relative error of 2^-53 each.
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
