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

// The instruction sets of this machine from `best` on: avx512, avx2, base. All of them if `best` is null.
// Throws std::invalid_argument if the machine does not have `best`.
std::vector<const Simd*> simd_sets_from(const char* best);
// The sets that are used. For measurements the environment variable STEREOTLM_VECTORS names the best of them.
const std::vector<const Simd*>& simd_sets();
inline const Simd& best_simd() { return *simd_sets().front(); }

}  // namespace stereotlm::kernels
