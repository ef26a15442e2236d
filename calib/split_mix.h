#pragma once

#include <cstdint>

namespace stereotlm::calib {

// SplitMix64 (Steele, Lea and Flood, 2014): its step and its mixing function.
inline constexpr std::uint64_t kSplitMixStep = 0x9E3779B97F4A7C15U;

constexpr std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ value >> 30U) * 0xBF58476D1CE4E5B9U;
  value = (value ^ value >> 27U) * 0x94D049BB133111EBU;
  return value ^ value >> 31U;
}

// Turns 64 random bits into a number of 53 bits, 0 <= number < 1.
constexpr double unit(std::uint64_t bits) {
  return static_cast<double>(static_cast<std::int64_t>(bits >> 11U)) *
         0x1p-53;  // a signed number converts faster
}

class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() { return mixed(state_ += kSplitMixStep); }
  double between(double low, double high) { return low + (high - low) * unit(next()); }
  // A random number that deviates from `value` by at most `part` * `value`.
  double about(double value, double part) { return value * between(1 - part, 1 + part); }

 private:
  std::uint64_t state_;
};

}  // namespace stereotlm::calib
