#include "models/kernels/column_simd.h"

#include <cstddef>
#include <cstdint>

#include "models/kernels/simd_loops.h"
#include "models/kernels/simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

// Longer vectors gain nothing here, and no vector may be longer than the padding of the arrays.
constexpr int kColumnBytes = kBytes < kLaneAlignment ? kBytes : kLaneAlignment;
constexpr int kHalves = kColumnBytes / 2;
constexpr int kWords = kColumnBytes / 4;

using Bytes = std::uint8_t __attribute__((vector_size(kHalves)));
using WordBytes = std::uint8_t __attribute__((vector_size(kWords)));
using Halves = std::int16_t __attribute__((vector_size(2 * kHalves)));
using WordHalves = std::int16_t __attribute__((vector_size(2 * kWords)));
using Words = std::int32_t __attribute__((vector_size(4 * kWords)));
using Floats = float __attribute__((vector_size(4 * kWords)));

Words words(int value) { return Words{} + value; }

// GCC's own conversion to longer vectors takes four instructions instead of one.
Halves widened(Bytes bytes) {
#if defined(__AVX2__)
  return reinterpret_cast<Halves>(_mm256_cvtepu8_epi16(reinterpret_cast<__m128i>(bytes)));
#else
  return __builtin_convertvector(bytes, Halves);
#endif
}

Words widened(WordHalves halves) {
#if defined(__AVX2__)
  return reinterpret_cast<Words>(_mm256_cvtepi16_epi32(reinterpret_cast<__m128i>(halves)));
#else
  return __builtin_convertvector(halves, Words);
#endif
}

}  // namespace

void step_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                  std::int16_t* leaving, std::int32_t* windows) {
  for (int d = 0; d < lanes; d += kHalves) {
    Halves sums{};
    for (int row = 0; row < rows; ++row) {
      const auto right = widened(load<Bytes>(histories[row] + d));
      const Halves difference = right - left[row];
      sums += difference < 0 ? -difference : difference;
    }
    const Halves change = sums - load<Halves>(leaving + d);
    store(sums, leaving + d);
    for (int part = 0; part < kHalves; part += kWords) {
      std::int32_t* const window = windows + d + part;
      const auto halves = load<WordHalves>(reinterpret_cast<const std::int16_t*>(&change) + part);
      store(load<Words>(window) + widened(halves), window);
    }
  }
}

namespace {

constexpr std::int32_t kNoKey = 0x7FFFFFFF;

// 0, 1, 2, ..
Words first_lanes() {
  Words lanes{};
  for (int lane = 0; lane < kWords; ++lane) lanes[lane] = lane;
  return lanes;
}

// The keys of the given lanes.
Words keys_at(const std::int32_t* sums, Words lanes, Words candidates) {
  const Words keys = load<Words>(sums) << 8 | lanes;
  return lanes < candidates ? keys : words(kNoKey);
}

std::int32_t smallest_lane(Words words) {
  using Block = std::int32_t __attribute__((vector_size(16)));
  auto block = load<Block>(&words);
  for (int more = 4; more < kWords; more += 4)
    block = smaller(block, load<Block>(reinterpret_cast<const std::int32_t*>(&words) + more));
  block = smaller(block, __builtin_shufflevector(block, block, 2, 3, 0, 1));
  block = smaller(block, __builtin_shufflevector(block, block, 1, 0, 3, 2));
  return block[0];
}

}  // namespace

void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* next) {
  Words numbers = first_lanes();
  for (int d = 0; d < lanes; d += kWords) {
    store(smaller(load<Words>(held + d - 1), keys_at(sums + d, numbers, words(candidates))), next + d);
    numbers += kWords;
  }
}

std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes) {
  Words numbers = first_lanes();
  Words best = words(kNoKey);
  for (int d = 0; d < lanes; d += kWords) {
    best = smaller(best, keys_at(sums + d, numbers, words(candidates)));
    numbers += kWords;
  }
  return smallest_lane(best);
}

namespace {

// The usual sizes are compiled for themselves: kSize is 0 for any other.
template <int kSize>
void filter_column_of(const float* columns, std::ptrdiff_t stride, const float* weights, int any_size,
                      int rows, int shift, std::uint8_t* out) {
  const int size = kSize != 0 ? kSize : any_size;
  for (int k = 0; k < rows; k += kWords) {
    // Four sums, because one alone would wait for itself.
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
    const auto sum = __builtin_convertvector((even + even_before) + (odd + odd_before), Words);
    const Words level = larger(smaller((sum >> shift) + 128, words(255)), words(0));
    store(__builtin_convertvector(level, WordBytes), out + k);
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
