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

void widen(const std::uint8_t* pixels, int width, std::int16_t* out) {
  for (std::ptrdiff_t u = 0; u < width; ++u) out[u] = pixels[u];
}

void add_rows(const std::int16_t* a, const std::int16_t* b, int width, std::int16_t* out) {
  for (std::ptrdiff_t u = 0; u < width; u += kLanes)
    store(load<Int16s>(a + u) + load<Int16s>(b + u), out + u);
}

// A block of neighbouring output pixels.
struct FilterBlock {
  Int16s vectors[kFilterVectors];
};

// Adds up the pixels of one weight, for the output pixels from column u on.
FilterBlock sum_of_taps(const std::int16_t* const* pixels, int count, std::ptrdiff_t u) {
  FilterBlock sum{};
  for (int i = 0; i < count; ++i) {
    for (std::ptrdiff_t v = 0; v < kFilterVectors; ++v)
      sum.vectors[v] += load<Int16s>(pixels[i] + u + v * kLanes);
  }
  return sum;
}

void filter_row(const FilterTaps& taps, int width, std::uint8_t* out) {
  for (std::ptrdiff_t u = 0; u < width; u += kFilterVectors * kLanes) {
    Int32s low[kFilterVectors] = {};
    Int32s high[kFilterVectors] = {};
    const std::int16_t* const* pixels = taps.pixels;
    for (int i = 0; i < taps.pair_count; ++i) {
      const WeightPair& pair = taps.pairs[i];
      const FilterBlock first = sum_of_taps(pixels, pair.first_count, u);
      pixels += pair.first_count;
      const FilterBlock second = sum_of_taps(pixels, pair.second_count, u);
      pixels += pair.second_count;
      const auto weights = reinterpret_cast<Int16s>(int32s(pair.weights));
      for (std::ptrdiff_t v = 0; v < kFilterVectors; ++v) {
        low[v] += multiply_pairs(low_pairs(first.vectors[v], second.vectors[v]), weights);
        high[v] += multiply_pairs(high_pairs(first.vectors[v], second.vectors[v]), weights);
      }
    }
    for (std::ptrdiff_t v = 0; v < kFilterVectors; ++v) {
      const Int16s level = pack(low[v] >> taps.shift, high[v] >> taps.shift);
      const Int16s clamped = larger(smaller(level, int16s(127)), int16s(-128)) + 128;
      store(__builtin_convertvector(clamped, HalfVectorBytes), out + u + v * kLanes);
    }
  }
}

void pair_pixels(const std::uint8_t* entering, const std::uint8_t* leaving, int width, std::int16_t* out) {
  for (std::ptrdiff_t i = 0; i < width; ++i)
    out[i] = static_cast<std::int16_t>(entering[i] | leaving[i] << 8);
}

// Images are transposed in blocks of 8 positions and 8 lanes; a vector holds kBlocks of them side by side.
constexpr std::ptrdiff_t kBlock = 8;
constexpr std::ptrdiff_t kBlocks = kLanes / kBlock;

// Loads 8 values of each array, side by side.
Int16s load_blocks(const std::int16_t* const* from, std::ptrdiff_t position) {
  using Block = std::int16_t __attribute__((vector_size(2 * kBlock)));
  const auto block = [&](std::ptrdiff_t index) { return load<Block>(from[index * kBlock] + position); };
#if defined(__AVX2__)
  const auto two_blocks = [&](std::ptrdiff_t first) {
    return __builtin_shufflevector(block(first), block(first + 1), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
                                   13, 14, 15);
  };
#endif
#if defined(__AVX512BW__)
  return reinterpret_cast<Int16s>(
      _mm512_maskz_inserti64x4(0xFF, _mm512_castsi256_si512(reinterpret_cast<__m256i>(two_blocks(0))),
                               reinterpret_cast<__m256i>(two_blocks(2)), 1));
#elif defined(__AVX2__)
  return two_blocks(0);
#else
  return block(0);
#endif
}

void transpose_blocks(Int16s (&rows)[kBlock]) {
  for (int step = 0; step < 3; ++step) {
    Int16s pairs[kBlock];
    for (std::ptrdiff_t i = 0; i < kBlock / 2; ++i) {
      pairs[2 * i] = low_pairs(rows[i], rows[i + kBlock / 2]);
      pairs[2 * i + 1] = high_pairs(rows[i], rows[i + kBlock / 2]);
    }
    for (std::ptrdiff_t i = 0; i < kBlock; ++i) rows[i] = pairs[i];
  }
}

void to_lanes(const std::int16_t* const* from, int count, std::int16_t* out) {
  for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
    Int16s rows[kBlock];
    for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load_blocks(from + k, i);
    transpose_blocks(rows);
    for (std::ptrdiff_t k = 0; k < kBlock; ++k) store(rows[k], out + (i + k) * kLanes);
  }
}

void from_lanes(const std::int16_t* from, int count, std::uint8_t* const* out) {
  for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
    Int16s rows[kBlock];
    for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load<Int16s>(from + (i + k) * kLanes);
    transpose_blocks(rows);
    for (std::ptrdiff_t k = 0; k < kBlock; ++k) {
      const auto bytes = __builtin_convertvector(rows[k], HalfVectorBytes);
      for (std::ptrdiff_t block = 0; block < kBlocks; ++block)
        __builtin_memcpy(out[kBlock * block + k] + i, reinterpret_cast<const char*>(&bytes) + kBlock * block,
                         kBlock);
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
