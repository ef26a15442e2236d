#include "models/kernels/frame_simd_vectors.h"
#include "models/kernels/simd_loops.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

void pair_pixels(const std::uint8_t* entering, const std::uint8_t* leaving, int width, std::int16_t* out) {
  for (std::ptrdiff_t i = 0; i < width; ++i)
    out[i] = static_cast<std::int16_t>(entering[i] | leaving[i] << 8);
}

namespace {

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

}  // namespace

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

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
