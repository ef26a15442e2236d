#pragma once

#include <vector>

#include "models/kernels/column_simd.h"
#include "models/kernels/frame_simd.h"

namespace stereotlm::kernels {

// The inner loops of the kernels, built once per instruction set. The results are exact, and the same with
// each.
struct Simd {
  const char* name;
  FrameSimd frame;
  ColumnSimd column;
};

// The instruction sets that this machine has, the best first: avx512, avx2, base. The environment variable
// STEREOTLM_VECTORS names the best one that is used, for measurements. Throws std::invalid_argument if the
// machine does not have it.
const std::vector<const Simd*>& simd_sets();
inline const Simd& best_simd() { return *simd_sets().front(); }

}  // namespace stereotlm::kernels
