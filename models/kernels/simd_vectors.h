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

#include "models/kernels/simd.h"

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

// Returns the vector. Compilers load a vector from memory once for each use, unless it comes from here.
template <class Vector>
Vector in_register(Vector vector) {
#if defined(__SSE2__)
  asm("" : "+x"(vector));
#endif
  return vector;
}

template <class Vector>
Vector smaller(Vector a, Vector b) {
  return a < b ? a : b;
}

template <class Vector>
Vector larger(Vector a, Vector b) {
  return a > b ? a : b;
}

constexpr std::ptrdiff_t kLanes = kBytes / 2;  // 16-bit lanes of a vector
static_assert(kBytes <= kMostFrameVectorBytes);

using Bytes = std::uint8_t __attribute__((vector_size(kBytes)));
using Int16s = std::int16_t __attribute__((vector_size(kBytes)));
using Int32s = std::int32_t __attribute__((vector_size(kBytes)));
using Doubles = double __attribute__((vector_size(kBytes)));
using HalfInt32s = std::int32_t __attribute__((vector_size(kBytes / 2)));
using HalfVectorBytes = std::uint8_t __attribute__((vector_size(kBytes / 2)));

inline Int16s int16s(int value) { return Int16s{} + static_cast<std::int16_t>(value); }
inline Int32s int32s(int value) { return Int32s{} + value; }

// Return the even or odd lanes, as 32-bit lanes.
inline Int32s even_lanes(Int16s lanes) { return reinterpret_cast<Int32s>(lanes) << 16 >> 16; }
inline Int32s odd_lanes(Int16s lanes) { return reinterpret_cast<Int32s>(lanes) >> 16; }
inline Int16s join_lanes(Int32s even, Int32s odd) {
  return reinterpret_cast<Int16s>((even & 0xFFFF) | odd << 16);
}

// By an intrinsic, because GCC's own conversion takes several instructions.
inline Doubles to_doubles(HalfInt32s lanes) {
#if defined(__AVX512BW__)
  return reinterpret_cast<Doubles>(_mm512_maskz_cvtepi32_pd(0xFF, reinterpret_cast<__m256i>(lanes)));
#elif defined(__AVX2__)
  return reinterpret_cast<Doubles>(_mm256_cvtepi32_pd(reinterpret_cast<__m128i>(lanes)));
#elif defined(__SSE2__)
  return reinterpret_cast<Doubles>(_mm_cvtepi32_pd(_mm_cvtsi64_si128(reinterpret_cast<std::int64_t>(lanes))));
#else
  return __builtin_convertvector(lanes, Doubles);
#endif
}

// Values of 32 bits, in separate vectors for even and odd lanes.
struct Int32Pair {
  Int32s even;
  Int32s odd;
};
template <>
inline Int32Pair load<Int32Pair>(const void* from) {
  const auto* halves = static_cast<const std::int16_t*>(from);
  return {load<Int32s>(halves), load<Int32s>(halves + kLanes)};
}
inline void store(const Int32Pair& pair, std::int16_t* to) {
  store(pair.even, to);
  store(pair.odd, to + kLanes);
}
inline Int32Pair operator+(const Int32Pair& a, const Int32Pair& b) {
  return {a.even + b.even, a.odd + b.odd};
}
inline Int32Pair operator-(const Int32Pair& a, const Int32Pair& b) {
  return {a.even - b.even, a.odd - b.odd};
}

// Pairs of a pixel that enters a window and one that leaves it, of even and of odd lanes.
struct PixelPairs {
  Int16s even;
  Int16s odd;
};
inline PixelPairs load_pairs(const std::int16_t* pixels) {
  return {load<Int16s>(pixels), load<Int16s>(pixels + kLanes)};
}

// Factors 1 and -1 for such a pair.
inline Int16s entering_minus_leaving() { return reinterpret_cast<Int16s>(int32s(1 - 65536)); }

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

// low_pairs() returns pairs of a lane of `a` and the same lane of `b`, for half of the lanes; high_pairs()
// does for the other half. pack() takes one 32-bit result for each pair, and puts all of them back in the
// order of the lanes. A result that does not fit into 16 bits becomes the nearest number that does.
#if defined(__AVX512BW__)
inline Int16s low_pairs(Int16s a, Int16s b) {
  return reinterpret_cast<Int16s>(
      _mm512_unpacklo_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
inline Int16s high_pairs(Int16s a, Int16s b) {
  return reinterpret_cast<Int16s>(
      _mm512_unpackhi_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
inline Int16s pack(Int32s low, Int32s high) {
  return reinterpret_cast<Int16s>(
      _mm512_packs_epi32(reinterpret_cast<__m512i>(low), reinterpret_cast<__m512i>(high)));
}
#elif defined(__AVX2__)
inline Int16s low_pairs(Int16s a, Int16s b) {
  return reinterpret_cast<Int16s>(
      _mm256_unpacklo_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
inline Int16s high_pairs(Int16s a, Int16s b) {
  return reinterpret_cast<Int16s>(
      _mm256_unpackhi_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
inline Int16s pack(Int32s low, Int32s high) {
  return reinterpret_cast<Int16s>(
      _mm256_packs_epi32(reinterpret_cast<__m256i>(low), reinterpret_cast<__m256i>(high)));
}
#else
inline Int16s low_pairs(Int16s a, Int16s b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
}
inline Int16s high_pairs(Int16s a, Int16s b) {
  return __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}
inline Int16s pack(Int32s low, Int32s high) {
#if defined(__SSE2__)
  return reinterpret_cast<Int16s>(
      _mm_packs_epi32(reinterpret_cast<__m128i>(low), reinterpret_cast<__m128i>(high)));
#else
  const auto clamped = [](Int32s lanes) {
    return reinterpret_cast<Int16s>(larger(smaller(lanes, int32s(32767)), int32s(-32768)));
  };
  return __builtin_shufflevector(clamped(low), clamped(high), 0, 2, 4, 6, 8, 10, 12, 14);
#endif
}
#endif

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
