#pragma once

// For the files that are compiled once per instruction set, in a namespace that STEREOTLM_SIMD names. Whatever
// these files define lies in that namespace and they use no function of the standard library: the linker
// keeps one copy of an inline function, which could be one that other machines cannot run.

#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace stereotlm::kernels::STEREOTLM_SIMD {

// The longest vector of the instruction set.
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
