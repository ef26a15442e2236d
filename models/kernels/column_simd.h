#pragma once

#include "models/kernels/simd_vectors.h"

// The loops over one column of the matcher (Simd).
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

// Longer vectors gain nothing here, and no vector may be longer than kLanePadding values.
constexpr int kColumnBytes = kBytes < 32 ? kBytes : 32;
constexpr int kWords = kColumnBytes / 2;  // 16-bit values in a vector
constexpr int kLongs = kColumnBytes / 4;  // 32-bit values in a vector

using WordBytes = std::uint8_t __attribute__((vector_size(kWords)));
using LongBytes = std::uint8_t __attribute__((vector_size(kLongs)));
using Words = std::int16_t __attribute__((vector_size(2 * kWords)));
using HalfWords = std::int16_t __attribute__((vector_size(2 * kLongs)));
using Longs = std::int32_t __attribute__((vector_size(4 * kLongs)));
using Reals = float __attribute__((vector_size(4 * kLongs)));

// GCC's own conversion to longer vectors takes four instructions instead of one.
Words widened(WordBytes bytes) {
#if defined(__AVX2__)
  return reinterpret_cast<Words>(_mm256_cvtepu8_epi16(reinterpret_cast<__m128i>(bytes)));
#else
  return __builtin_convertvector(bytes, Words);
#endif
}

Longs widened(HalfWords values) {
#if defined(__AVX2__)
  return reinterpret_cast<Longs>(_mm256_cvtepi16_epi32(reinterpret_cast<__m128i>(values)));
#else
  return __builtin_convertvector(values, Longs);
#endif
}

// Adds the column sums less those that leave to the window sums, and stores them in their place.
void replace_columns(Words sums, std::int16_t* leaving, std::int32_t* windows) {
  const Words change = sums - load<Words>(leaving);
  store(sums, leaving);
  for (int part = 0; part < kWords; part += kLongs) {
    std::int32_t* const window = windows + part;
    const auto changes = load<HalfWords>(reinterpret_cast<const std::int16_t*>(&change) + part);
    store(load<Longs>(window) + widened(changes), window);
  }
}

// ssd_windows and product_windows. `cost_of`: the cost of right pixels and a left pixel.
template <class CostOf>
void step_wide_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                       std::int32_t* leaving, std::int32_t* windows, CostOf cost_of) {
  for (int d = 0; d < lanes; d += kLongs) {
    Longs sums{};
    for (int row = 0; row < rows; ++row) {
      const auto right = __builtin_convertvector(load<LongBytes>(histories[row] + d), Longs);
      sums += cost_of(right, left[row]);
    }
    store(load<Longs>(windows + d) + sums - load<Longs>(leaving + d), windows + d);
    store(sums, leaving + d);
  }
}

void sad_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int16_t* leaving, std::int32_t* windows) {
  for (int d = 0; d < lanes; d += kWords) {
    Words sums{};
    for (int row = 0; row < rows; ++row) {
      const auto right = widened(load<WordBytes>(histories[row] + d));
      const Words difference = right - left[row];
      sums += difference < 0 ? -difference : difference;
    }
    replace_columns(sums, leaving + d, windows + d);
  }
}

void census_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                    std::int16_t* leaving, std::int32_t* windows) {
  for (int d = 0; d < lanes; d += kWords) {
    Words sums{};
    for (int row = 0; row < rows; ++row) {
      WordBytes bits = load<WordBytes>(histories[row] + d) ^ left[row];
      bits -= bits >> 1 & 0x55;
      bits = (bits & 0x33) + (bits >> 2 & 0x33);
      sums += widened((bits + (bits >> 4)) & 0x0F);
    }
    replace_columns(sums, leaving + d, windows + d);
  }
}

void ssd_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int32_t* leaving, std::int32_t* windows) {
  step_wide_windows(histories, left, rows, lanes, leaving, windows, [](Longs right, int left_pixel) {
    const Longs difference = right - left_pixel;
    return difference * difference;
  });
}

void product_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                     std::int32_t* leaving, std::int32_t* windows) {
  step_wide_windows(histories, left, rows, lanes, leaving, windows,
                    [](Longs right, int left_pixel) { return right * left_pixel; });
}

// The key of a disparity. The compiler makes vectors of the loops over keys.
std::int32_t key_of(std::int32_t sum, int d, int candidates) {
  return d < candidates ? sum * 256 + d : INT32_MAX;
}

void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* __restrict next) {
  for (int d = 0; d < lanes; ++d) next[d] = smaller(held[d - 1], key_of(sums[d], d, candidates));
}

std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes) {
  std::int32_t best = INT32_MAX;
  for (int d = 0; d < lanes; ++d) best = smaller(best, key_of(sums[d], d, candidates));
  return best;
}

// Compiled separately for each usual size of the kernel. kSize is 0 for all other sizes.
template <int kSize>
void filter_column_of(const float* columns, std::ptrdiff_t stride, const float* weights, int any_size,
                      int rows, int shift, std::uint8_t* out) {
  const int size = kSize != 0 ? kSize : any_size;
  for (int k = 0; k < rows; k += kLongs) {
    // Four independent sums, because each addition to one sum waits for the one before.
    Reals even{};
    Reals odd{};
    Reals even_before{};
    Reals odd_before{};
    const float* weight = weights;
    const float* tap = columns + k;
    for (int i = 0; i < size; ++i, weight += size, tap += stride) {
      for (int j = 0; j + 1 < size; j += 2) {
        even += load<Reals>(tap + j) * weight[j];
        odd += load<Reals>(tap + j + 1) * weight[j + 1];
      }
      even += load<Reals>(tap + size - 1) * weight[size - 1];
      const Reals even_now = even;
      const Reals odd_now = odd;
      even = even_before;
      odd = odd_before;
      even_before = even_now;
      odd_before = odd_now;
    }
    const auto sum = __builtin_convertvector((even + even_before) + (odd + odd_before), Longs);
    const Longs level = larger(smaller((sum >> shift) + 128, Longs{} + 255), Longs{});
    store(__builtin_convertvector(level, LongBytes), out + k);
  }
}

void filter_column(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                   int shift, std::uint8_t* out) {
  switch (size) {
    case 3:
      return filter_column_of<3>(columns, stride, weights, size, rows, shift, out);
    case 5:
      return filter_column_of<5>(columns, stride, weights, size, rows, shift, out);
    case 7:
      return filter_column_of<7>(columns, stride, weights, size, rows, shift, out);
    default:
      return filter_column_of<0>(columns, stride, weights, size, rows, shift, out);
  }
}

}  // namespace
}  // namespace stereotlm::kernels::STEREOTLM_SIMD
