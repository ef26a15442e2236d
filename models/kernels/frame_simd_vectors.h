#pragma once

#include "models/kernels/frame_simd.h"
#include "models/kernels/simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

// The vector types and lane arithmetic that the frame_simd_*.cpp files share. They are compiled once per
// instruction set.

constexpr std::ptrdiff_t kLanes = kBytes / 2;  // 16-bit lanes of a vector
static_assert(kBytes <= kMostFrameVectorBytes);

using Bytes = std::uint8_t __attribute__((vector_size(kBytes)));
using Int16s = std::int16_t __attribute__((vector_size(kBytes)));
using Int32s = std::int32_t __attribute__((vector_size(kBytes)));
using HalfVectorBytes = std::uint8_t __attribute__((vector_size(kBytes / 2)));

inline Int16s int16s(int value) { return Int16s{} + static_cast<std::int16_t>(value); }
inline Int32s int32s(int value) { return Int32s{} + value; }

// Return the even or odd lanes, as 32-bit lanes.
inline Int32s even_lanes(Int16s lanes) { return reinterpret_cast<Int32s>(lanes) << 16 >> 16; }
inline Int32s odd_lanes(Int16s lanes) { return reinterpret_cast<Int32s>(lanes) >> 16; }
inline Int16s join_lanes(Int32s even, Int32s odd) {
  return reinterpret_cast<Int16s>((even & 0xFFFF) | odd << 16);
}

// Multiplies lane by lane and adds the products of neighbours.
inline Int32s multiply_pairs(Int16s a, Int16s b) {
#if defined(__AVX512BW__)
  return reinterpret_cast<Int32s>(
      _mm512_madd_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
#elif defined(__AVX2__)
  return reinterpret_cast<Int32s>(
      _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<Int32s>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return even_lanes(a) * even_lanes(b) + odd_lanes(a) * odd_lanes(b);
#endif
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
