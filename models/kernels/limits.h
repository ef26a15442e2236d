#pragma once

#include "models/kernels/integer_rule.h"

// The allowed values of the parameters of contract section 1.
namespace stereotlm::kernels {

inline constexpr IntegerRule kWindowRule{3, 31, 2};     // n, pixels
inline constexpr IntegerRule kDisparitiesRule{1, 254};  // D, candidates
inline constexpr IntegerRule kLrToleranceRule{0, 253};  // difference of two disparities

}  // namespace stereotlm::kernels
