#pragma once

#include "models/kernels/simd_vectors.h"

// The loops over whole images that do not match (Simd).
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

void rectify(const std::uint8_t* source, const std::uint32_t* table, int count, int width,
             std::uint8_t* out) {
  // An entry is a pair of 16-bit numbers: the column, and the row with the valid bit above it.
  const auto weights = reinterpret_cast<Int16s>(int32s(width << 16 | 1));
  constexpr int kChunk = 512;
  alignas(kBytes) std::uint32_t places[kChunk];
  for (; count > 0; count -= kChunk, table += kChunk, out += kChunk) {
    const int pixels = count < kChunk ? count : kChunk;
    std::ptrdiff_t i = 0;
    for (; i + kLanes / 2 <= pixels; i += kLanes / 2) {
      const auto entries = load<Int32s>(table + i);
      store(multiply_pairs(reinterpret_cast<Int16s>(entries & entries >> 31 & 0x7FF07FF), weights),
            places + i);
    }
    for (; i < pixels; ++i) {
      const std::uint32_t entry = table[i] >> 31 != 0 ? table[i] : 0;
      places[i] = (entry >> 16 & 0x7FF) * static_cast<std::uint32_t>(width) + (entry & 0x7FF);
    }
    for (i = 0; i < pixels; ++i) out[i] = source[places[i]];
    for (i = 0; i < pixels; ++i) out[i] &= static_cast<std::uint8_t>(table[i] >> 31 != 0 ? 0xFF : 0);
  }
}

// Sums the first row and, with kSecond, the second. Stores the sum in `out` or, with kMore, adds it to `out`.
template <bool kMore, bool kSecond>
void add_two_rows(const std::uint8_t* first, const std::uint8_t* second, int width, std::int16_t* out) {
  std::ptrdiff_t u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    Int16s sum = __builtin_convertvector(load<HalfVectorBytes>(first + u), Int16s);
    if (kSecond) sum += __builtin_convertvector(load<HalfVectorBytes>(second + u), Int16s);
    if (kMore) sum += load<Int16s>(out + u);
    store(sum, out + u);
  }
  for (; u < width; ++u)
    out[u] = static_cast<std::int16_t>(first[u] + (kSecond ? second[u] : 0) + (kMore ? out[u] : 0));
}

void add_rows(const std::uint8_t* const* rows, int count, int width, std::int16_t* out) {
  if (count == 1) {
    add_two_rows<false, false>(rows[0], nullptr, width, out);
  } else {
    add_two_rows<false, true>(rows[0], rows[1], width, out);
  }
  for (int row = 2; row + 1 < count; row += 2) add_two_rows<true, true>(rows[row], rows[row + 1], width, out);
  if (count > 2 && count % 2 != 0) add_two_rows<true, false>(rows[count - 1], nullptr, width, out);
}

Int32s level(Int32s sum, int shift) { return larger(smaller(sum >> shift, int32s(127)), int32s(-128)) + 128; }

void filter_row(const std::int16_t* const* rows, const FilterTaps& taps, int width, std::uint8_t* out) {
  constexpr int kVectors = 2;
  for (std::ptrdiff_t u = 0; u < width; u += kVectors * kLanes) {
    // Sums for the output pixels at even and at odd positions.
    Int32s even[kVectors] = {};
    Int32s odd[kVectors] = {};
    const std::int32_t* weight = taps.weights;
    for (int row = 0; row < taps.rows; ++row) {
      const std::int16_t* pixels = rows[row] + u;
      for (int pair = 0; pair < taps.pairs; ++pair, pixels += 2) {
        const auto weights = reinterpret_cast<Int16s>(int32s(*weight++));
        for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
          even[v] += multiply_pairs(load<Int16s>(pixels + v * kLanes), weights);
          odd[v] += multiply_pairs(load<Int16s>(pixels + v * kLanes + 1), weights);
        }
      }
    }
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      const Int16s levels = join_lanes(level(even[v], taps.shift), level(odd[v], taps.shift));
      store(__builtin_convertvector(levels, HalfVectorBytes), out + u + v * kLanes);
    }
  }
}

void pair_pixels(const std::uint8_t* entering, const std::uint8_t* leaving, int width, std::int16_t* out) {
  for (std::ptrdiff_t i = 0; i < width; ++i)
    out[i] = static_cast<std::int16_t>(entering[i] | leaving[i] << 8);
}

// Images are transposed in blocks of 8 x 8 lanes, with any instruction set.
constexpr std::ptrdiff_t kBlock = 8;
using Block8 = std::uint8_t __attribute__((vector_size(8)));
using Block16 = std::int16_t __attribute__((vector_size(16)));

void transpose(Block16 (&rows)[kBlock]) {
  Block16 a[kBlock];
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    a[2 * i] = __builtin_shufflevector(rows[i], rows[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    a[2 * i + 1] = __builtin_shufflevector(rows[i], rows[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
  Block16 b[kBlock];
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    b[2 * i] = __builtin_shufflevector(a[i], a[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    b[2 * i + 1] = __builtin_shufflevector(a[i], a[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    rows[2 * i] = __builtin_shufflevector(b[i], b[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    rows[2 * i + 1] = __builtin_shufflevector(b[i], b[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
}

void to_lanes(const std::int16_t* const* from, int count, std::int16_t* out) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; lane += kBlock) {
    for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
      Block16 rows[kBlock];
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load<Block16>(from[lane + k] + i);
      transpose(rows);
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) store(rows[k], out + (i + k) * kLanes + lane);
    }
  }
}

void from_lanes(const std::int16_t* from, int count, std::uint8_t* const* out) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; lane += kBlock) {
    for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
      Block16 rows[kBlock];
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load<Block16>(from + (i + k) * kLanes + lane);
      transpose(rows);
      for (std::ptrdiff_t k = 0; k < kBlock; ++k)
        store(__builtin_convertvector(rows[k], Block8), out[lane + k] + i);
    }
  }
}

// kernels::kInvalidDisparity. Its header has inline functions, which must not be compiled with the
// instructions of this file.
constexpr std::uint8_t kInvalid = 0xFF;

// Stores the disparities of `left` that agree with those of `right`, in the next `count` pixels.
void check(const std::uint8_t* left, const std::uint8_t* right, int count, int tolerance, std::uint8_t* out) {
  const Bytes most = Bytes{} + static_cast<std::uint8_t>(tolerance);
  std::ptrdiff_t i = 0;
  for (; i + kBytes <= count; i += kBytes) {
    const auto l = load<Bytes>(left + i);
    const auto r = load<Bytes>(right + i);
    const Bytes difference = l > r ? l - r : r - l;
    const auto fails = reinterpret_cast<Bytes>((difference > most) | (r == kInvalid));
    store(l | fails, out + i);
  }
  for (; i < count; ++i) {
    const int difference = left[i] > right[i] ? left[i] - right[i] : right[i] - left[i];
    out[i] = difference > tolerance || right[i] == kInvalid ? kInvalid : left[i];
  }
}

void check_row(const std::uint8_t* left_based, const std::uint8_t* right_based,
               const std::uint32_t* left_table, int count, int tolerance, std::uint8_t* out) {
  if (right_based == nullptr) {
    __builtin_memcpy(out, left_based, static_cast<std::size_t>(count));
  } else {
    constexpr std::ptrdiff_t kChunk = 512;
    std::uint8_t pointed_to[kChunk];
    for (std::ptrdiff_t begin = 0; begin < count; begin += kChunk) {
      const std::ptrdiff_t pixels = count - begin < kChunk ? count - begin : kChunk;
      const std::uint8_t* const left = left_based + begin;
      const std::uint8_t* const right = right_based + begin;
      // No vectors here, because the addresses differ from pixel to pixel.
#pragma GCC unroll 8
      for (std::ptrdiff_t i = 0; i < pixels; ++i) pointed_to[i] = right[i - left[i]];
      check(left, pointed_to, static_cast<int>(pixels), tolerance, out + begin);
    }
  }
  if (left_table == nullptr) return;
  for (std::ptrdiff_t i = 0; i < count; ++i) out[i] |= left_table[i] >> 31 == 0 ? kInvalid : std::uint8_t{0};
}

using SignedBytes = std::int8_t __attribute__((vector_size(kBytes)));

void census_row(const std::int8_t* const* rows, int half, int width, std::uint8_t* const* out) {
  for (std::ptrdiff_t u = 0; u < width; u += kBytes) {
    const auto middle = load<SignedBytes>(rows[half] + half + u);
    Bytes set{};
    int bit = 0;
    for (int row = 0; row <= 2 * half; ++row) {
      for (int column = 0; column <= 2 * half; ++column) {
        if (row == half && column == half) continue;
        const auto is_less = reinterpret_cast<Bytes>(load<SignedBytes>(rows[row] + column + u) < middle);
        const auto mask = static_cast<std::uint8_t>(1U << static_cast<unsigned>(bit % 8));
        set |= is_less & mask;
        if (++bit % 8 != 0) continue;
        store(set, out[bit / 8 - 1] + u);
        set = Bytes{};
      }
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels::STEREOTLM_SIMD
