#pragma once

#include <vector>

#include "models/kernels/column_simd.h"
#include "models/kernels/correlation_simd.h"
#include "models/kernels/frame_simd.h"

namespace stereotlm::kernels {

// The inner loops of the kernels, built once per instruction set. The results are exact, and the same with
// each instruction set.
struct Simd {
  const char* name;
  FrameSimd frame;
  ColumnSimd column;
  CorrelationSimd correlation;
};

// Returns the instruction sets of this machine from `best` on, in the order avx512, avx2, base; all of them
// if `best` is null. Throws std::invalid_argument if the machine does not have `best`.
std::vector<const Simd*> simd_sets_from(const char* best);
// The instruction sets that the kernels may use, best first. For measurements the environment variable
// STEREOTLM_VECTORS names the first one.
const std::vector<const Simd*>& simd_sets();
inline const Simd& best_simd() { return *simd_sets().front(); }

}  // namespace stereotlm::kernels
