#pragma once

#include <cstdint>
#include <optional>

namespace stereotlm {

// The whole number nearest to `value`, halves up, if that is certain: `value` was computed in a few
// operations, each right to a part in 2^53, and is not negative. None if it lies too near to a half, or is
// too large to tell: the exact computation, which costs several times as much, is then called for.
inline std::optional<std::uint64_t> rounded_if_certain(double value) {
  constexpr double kDoubt = 0x1p-50;  // of the value
  constexpr double kLargest = 0x1p48;
  if (!(value < kLargest)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(value);
  const double beyond_half = value - static_cast<double>(whole) - 0.5;
  const double doubt = value * kDoubt;
  if (beyond_half > doubt) return static_cast<std::uint64_t>(whole) + 1;
  if (beyond_half < -doubt) return static_cast<std::uint64_t>(whole);
  return std::nullopt;
}

}  // namespace stereotlm
