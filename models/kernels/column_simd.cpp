#include "models/kernels/column_simd.h"

#include <cstddef>
#include <cstdint>

#include "models/kernels/simd_loops.h"
#include "models/kernels/simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

// Longer vectors gain nothing here, and no vector may be longer than the padding of the arrays.
constexpr int kColumnBytes = kBytes < kLaneAlignment ? kBytes : kLaneAlignment;
constexpr int kInt16s = kColumnBytes / 2;  // 16-bit values in a vector
constexpr int kInt32s = kColumnBytes / 4;  // 32-bit values in a vector

using HalfBytes = std::uint8_t __attribute__((vector_size(kInt16s)));
using QuarterBytes = std::uint8_t __attribute__((vector_size(kInt32s)));
using Int16s = std::int16_t __attribute__((vector_size(2 * kInt16s)));
using HalfInt16s = std::int16_t __attribute__((vector_size(2 * kInt32s)));
using Int32s = std::int32_t __attribute__((vector_size(4 * kInt32s)));
using Floats = float __attribute__((vector_size(4 * kInt32s)));

Int32s int32s(int value) { return Int32s{} + value; }

// GCC's own conversion to longer vectors takes four instructions instead of one.
Int16s widened(HalfBytes bytes) {
#if defined(__AVX2__)
  return reinterpret_cast<Int16s>(_mm256_cvtepu8_epi16(reinterpret_cast<__m128i>(bytes)));
#else
  return __builtin_convertvector(bytes, Int16s);
#endif
}

Int32s widened(HalfInt16s values) {
#if defined(__AVX2__)
  return reinterpret_cast<Int32s>(_mm256_cvtepi16_epi32(reinterpret_cast<__m128i>(values)));
#else
  return __builtin_convertvector(values, Int32s);
#endif
}

// Adds the column sums less those that leave to the window sums, and stores them in their place.
void replace_columns(Int16s sums, std::int16_t* leaving, std::int32_t* windows) {
  const Int16s change = sums - load<Int16s>(leaving);
  store(sums, leaving);
  for (int part = 0; part < kInt16s; part += kInt32s) {
    std::int32_t* const window = windows + part;
    const auto changes = load<HalfInt16s>(reinterpret_cast<const std::int16_t*>(&change) + part);
    store(load<Int32s>(window) + widened(changes), window);
  }
}

// ColumnSimd::ssd_windows and product_windows. `cost_of`: the cost of right pixels and a left pixel.
template <class CostOf>
void step_wide_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                       std::int32_t* leaving, std::int32_t* windows, CostOf cost_of) {
  for (int d = 0; d < lanes; d += kInt32s) {
    Int32s sums{};
    for (int row = 0; row < rows; ++row) {
      const auto right = __builtin_convertvector(load<QuarterBytes>(histories[row] + d), Int32s);
      sums += cost_of(right, left[row]);
    }
    store(load<Int32s>(windows + d) + sums - load<Int32s>(leaving + d), windows + d);
    store(sums, leaving + d);
  }
}

}  // namespace

void sad_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int16_t* leaving, std::int32_t* windows) {
  for (int d = 0; d < lanes; d += kInt16s) {
    Int16s sums{};
    for (int row = 0; row < rows; ++row) {
      const auto right = widened(load<HalfBytes>(histories[row] + d));
      const Int16s difference = right - left[row];
      sums += difference < 0 ? -difference : difference;
    }
    replace_columns(sums, leaving + d, windows + d);
  }
}

void census_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                    std::int16_t* leaving, std::int32_t* windows) {
  for (int d = 0; d < lanes; d += kInt16s) {
    Int16s sums{};
    for (int row = 0; row < rows; ++row) {
      HalfBytes bits = load<HalfBytes>(histories[row] + d) ^ left[row];
      bits -= bits >> 1 & 0x55;
      bits = (bits & 0x33) + (bits >> 2 & 0x33);
      sums += widened((bits + (bits >> 4)) & 0x0F);
    }
    replace_columns(sums, leaving + d, windows + d);
  }
}

void ssd_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int32_t* leaving, std::int32_t* windows) {
  step_wide_windows(histories, left, rows, lanes, leaving, windows, [](Int32s right, int left_pixel) {
    const Int32s difference = right - left_pixel;
    return difference * difference;
  });
}

void product_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                     std::int32_t* leaving, std::int32_t* windows) {
  step_wide_windows(histories, left, rows, lanes, leaving, windows,
                    [](Int32s right, int left_pixel) { return right * left_pixel; });
}

namespace {

// The key of a disparity. The compiler makes vectors of the loops over keys.
std::int32_t key_of(std::int32_t sum, int d, int candidates) {
  return d < candidates ? sum * 256 + d : INT32_MAX;
}

}  // namespace

void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* __restrict next) {
  for (int d = 0; d < lanes; ++d) next[d] = smaller(held[d - 1], key_of(sums[d], d, candidates));
}

std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes) {
  std::int32_t best = INT32_MAX;
  for (int d = 0; d < lanes; ++d) best = smaller(best, key_of(sums[d], d, candidates));
  return best;
}

namespace {

// Compiled separately for each usual size of the kernel. kSize is 0 for all other sizes.
template <int kSize>
void filter_column_of(const float* columns, std::ptrdiff_t stride, const float* weights, int any_size,
                      int rows, int shift, std::uint8_t* out) {
  const int size = kSize != 0 ? kSize : any_size;
  for (int k = 0; k < rows; k += kInt32s) {
    // Four independent sums, because each addition to one sum waits for the one before.
    Floats even{};
    Floats odd{};
    Floats even_before{};
    Floats odd_before{};
    const float* weight = weights;
    const float* tap = columns + k;
    for (int i = 0; i < size; ++i, weight += size, tap += stride) {
      for (int j = 0; j + 1 < size; j += 2) {
        even += load<Floats>(tap + j) * weight[j];
        odd += load<Floats>(tap + j + 1) * weight[j + 1];
      }
      even += load<Floats>(tap + size - 1) * weight[size - 1];
      const Floats even_now = even;
      const Floats odd_now = odd;
      even = even_before;
      odd = odd_before;
      even_before = even_now;
      odd_before = odd_now;
    }
    const auto sum = __builtin_convertvector((even + even_before) + (odd + odd_before), Int32s);
    const Int32s level = larger(smaller((sum >> shift) + 128, int32s(255)), int32s(0));
    store(__builtin_convertvector(level, QuarterBytes), out + k);
  }
}

}  // namespace

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

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
