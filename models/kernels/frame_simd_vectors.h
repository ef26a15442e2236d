#pragma once

#include "models/kernels/frame_simd.h"
#include "models/kernels/simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

constexpr std::ptrdiff_t kLanes = kBytes / 2;
static_assert(kBytes <= kMostFrameVectorBytes);

using Bytes = std::uint8_t __attribute__((vector_size(kBytes)));
using Halves = std::int16_t __attribute__((vector_size(kBytes)));
using Words = std::int32_t __attribute__((vector_size(kBytes)));
using HalfBytes = std::uint8_t __attribute__((vector_size(kBytes / 2)));

inline Halves halves(int value) { return Halves{} + static_cast<std::int16_t>(value); }
inline Words words(int value) { return Words{} + value; }

// Even and odd lanes as 32-bit lanes.
inline Words even_lanes(Halves lanes) { return reinterpret_cast<Words>(lanes) << 16 >> 16; }
inline Words odd_lanes(Halves lanes) { return reinterpret_cast<Words>(lanes) >> 16; }
inline Halves join_lanes(Words even, Words odd) {
  return reinterpret_cast<Halves>((even & 0xFFFF) | odd << 16);
}

// Multiplies lane by lane and adds the products of neighbours.
inline Words multiply_pairs(Halves a, Halves b) {
#if defined(__AVX512BW__)
  return reinterpret_cast<Words>(
      _mm512_madd_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
#elif defined(__AVX2__)
  return reinterpret_cast<Words>(
      _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<Words>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return even_lanes(a) * even_lanes(b) + odd_lanes(a) * odd_lanes(b);
#endif
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
