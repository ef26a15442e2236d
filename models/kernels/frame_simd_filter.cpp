#include "models/kernels/frame_simd_vectors.h"
#include "models/kernels/simd_loops.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

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

namespace {

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

}  // namespace

void add_rows(const std::uint8_t* const* rows, int count, int width, std::int16_t* out) {
  if (count == 1) {
    add_two_rows<false, false>(rows[0], nullptr, width, out);
  } else {
    add_two_rows<false, true>(rows[0], rows[1], width, out);
  }
  for (int row = 2; row + 1 < count; row += 2) add_two_rows<true, true>(rows[row], rows[row + 1], width, out);
  if (count > 2 && count % 2 != 0) add_two_rows<true, false>(rows[count - 1], nullptr, width, out);
}

namespace {

Int32s level(Int32s sum, int shift) { return larger(smaller(sum >> shift, int32s(127)), int32s(-128)) + 128; }

}  // namespace

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

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
