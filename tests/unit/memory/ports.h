#pragma once

#include <cstddef>
#include <string>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// The ports of these tests.
namespace port {
inline constexpr Port kLeftLut = 0;
inline constexpr Port kRightLut = 1;
inline constexpr Port kLeftPixel = 2;
inline constexpr Port kRightPixel = 3;
inline constexpr Port kResult = 4;
inline constexpr Port kHost = 5;
}  // namespace port
inline constexpr std::size_t kGroupCount = 6;

inline constexpr PortMask kNone = 0;
inline constexpr PortMask kAll = (1U << kGroupCount) - 1;
inline constexpr PortMask kLeft = mask_of(port::kLeftPixel);
inline constexpr PortMask kRight = mask_of(port::kRightPixel);
inline constexpr PortMask kResult = mask_of(port::kResult);
inline constexpr PortMask kHost = mask_of(port::kHost);

inline ArbiterConfig arbiter_of(const std::string& policy) {
  return {policy,
          {port::kHost, port::kResult, port::kLeftPixel, port::kRightPixel, port::kLeftLut, port::kRightLut}};
}
inline const ArbiterConfig kFixedPriority = arbiter_of("fixed_priority");

}  // namespace stereotlm::memory
