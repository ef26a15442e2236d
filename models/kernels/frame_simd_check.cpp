#include "models/kernels/frame_simd_vectors.h"
#include "models/kernels/simd_loops.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

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

}  // namespace

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

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
