#pragma once

#include <ostream>

#include "models/area/parts.h"

// For comparisons of resources in tests.
namespace stereotlm::area {

inline bool operator==(const Resources& a, const Resources& b) {
  return a.luts == b.luts && a.flip_flops == b.flip_flops && a.block_rams == b.block_rams &&
         a.multipliers == b.multipliers;
}

inline std::ostream& operator<<(std::ostream& out, const Resources& r) {
  return out << r.luts << " LUTs, " << r.flip_flops << " flip-flops, " << r.block_rams << " block RAMs, "
             << r.multipliers << " multipliers";
}

}  // namespace stereotlm::area
