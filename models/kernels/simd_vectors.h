#pragma once

// Vectors, as an extension of the compiler, for the files that are compiled once per instruction set.
// STEREOTLM_SIMD is the namespace of everything that these files define. They use no function of the standard
// library: the linker keeps only one copy of an inline function, which could be one that older machines
// cannot run.

#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace stereotlm::kernels::STEREOTLM_SIMD {

// Bytes of the longest vector of the instruction set.
#if defined(__AVX512BW__)
constexpr int kBytes = 64;
#elif defined(__AVX2__)
constexpr int kBytes = 32;
#else
constexpr int kBytes = 16;
#endif

template <class Vector>
Vector load(const void* from) {
  Vector vector;
  __builtin_memcpy(&vector, from, sizeof vector);
  return vector;
}

template <class Vector>
void store(const Vector& vector, void* to) {
  __builtin_memcpy(to, &vector, sizeof vector);
}

template <class Vector>
Vector smaller(Vector a, Vector b) {
  return a < b ? a : b;
}

template <class Vector>
Vector larger(Vector a, Vector b) {
  return a > b ? a : b;
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
