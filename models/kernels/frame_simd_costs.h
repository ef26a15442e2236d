#pragma once

#include "models/kernels/frame_simd_match.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

// A cost that takes the pixels as they are.
template <class KeysOfCost>
struct PackedCost {
  using Keys = KeysOfCost;
  static constexpr bool kUnpacks = false;

  static void prepare(const MatchPlan& /*plan*/, const MatchMemory& /*memory*/) {}
  static const std::int16_t* pixels(const MatchSide& side) { return side.pixels; }
};

// Sum of absolute differences.
template <class Keys>
struct SadCost : PackedCost<Keys> {
  using Sum = Int16s;
  static constexpr std::ptrdiff_t kPixelLanes = kLanes;
  static constexpr std::ptrdiff_t kSumLanes = kLanes;

  explicit SadCost(const MatchMemory& /*memory*/) {}
  static Int16s right(const std::int16_t* pixels) { return load<Int16s>(pixels); }
  static Sum change(Int16s right_pixels, const std::int16_t* left_pixels) {
    const auto a = reinterpret_cast<Bytes>(right_pixels);
    const auto b = in_register(load<Bytes>(left_pixels));
    return difference_of_bytes<Keys::kScale>(larger(a, b) - smaller(a, b));
  }
};

MatchLoops sad_loops(int window) {
  return window * window * 255 <= kLargestNarrowSum ? loops_of<SadCost<NarrowKeys>>()
                                                    : loops_of<SadCost<WideKeys>>();
}

// Sum of squared differences. The pixels are multiplied by kFactor first, so that the sums have the scale of
// the keys.
template <class KeysOfCost, int kFactor>
struct SsdCost {
  using Keys = KeysOfCost;
  static_assert(kFactor * kFactor == Keys::kSumScale);
  using Sum = Int32Pair;
  static constexpr std::ptrdiff_t kPixelLanes = 2 * kLanes;
  static constexpr std::ptrdiff_t kSumLanes = 2 * kLanes;
  static constexpr bool kUnpacks = true;

  explicit SsdCost(const MatchMemory& /*memory*/) {}
  static void prepare(const MatchPlan& plan, const MatchMemory& memory) {
    const int positions = plan.columns + plan.window - 1;
    unpack<kFactor, kFactor>(memory.right.pixels, positions, memory.right.unpacked);
    unpack<kFactor, kFactor>(memory.left.pixels, positions + plan.disparities - 1, memory.left.unpacked);
  }
  static const std::int16_t* pixels(const MatchSide& side) { return side.unpacked; }

  static PixelPairs right(const std::int16_t* pixels) { return load_pairs(pixels); }
  static Sum change(const PixelPairs& right_pixels, const std::int16_t* left_pixels) {
    return {change(right_pixels.even - load<Int16s>(left_pixels)),
            change(right_pixels.odd - load<Int16s>(left_pixels + kLanes))};
  }

 private:
  // The square of the difference that enters, minus the square of the one that leaves.
  static Int32s change(Int16s differences) {
    return multiply_pairs(differences, differences * entering_minus_leaving());
  }
};

MatchLoops ssd_loops(int window) {
  return window * window <= kLargestWideSum / (255 * 255) ? loops_of<SsdCost<WideKeys, 16>>()
                                                          : loops_of<SsdCost<WideGroupKeys, 2>>();
}

// Hamming distances of census bits. A pixel has 8 bits in each of kPlanes bytes.

using Uint16s = std::uint16_t __attribute__((vector_size(kBytes)));

Bytes bytes(int value) { return Bytes{} + static_cast<std::uint8_t>(value); }
Bytes shifted_right(Bytes lanes, int bits) {
  return reinterpret_cast<Bytes>(reinterpret_cast<Uint16s>(lanes) >> static_cast<std::uint16_t>(bits));
}

#if defined(__AVX2__)
// Returns the bits set in the lowest four bits of each byte, times kWeight.
template <int kWeight>
Bytes set_in_nibbles(Bytes nibbles) {
  Bytes counts{};
  for (int i = 0; i < kBytes; ++i)
    counts[i] = static_cast<std::uint8_t>(kWeight * ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1) + (i >> 3 & 1)));
#if defined(__AVX512BW__)
  return reinterpret_cast<Bytes>(
      _mm512_shuffle_epi8(reinterpret_cast<__m512i>(counts), reinterpret_cast<__m512i>(nibbles)));
#else
  return reinterpret_cast<Bytes>(
      _mm256_shuffle_epi8(reinterpret_cast<__m256i>(counts), reinterpret_cast<__m256i>(nibbles)));
#endif
}

template <int kWeight>
Bytes set_bits(Bytes lanes) {
  return set_in_nibbles<kWeight>(lanes & bytes(0x0F)) +
         set_in_nibbles<kWeight>(shifted_right(lanes, 4) & bytes(0x0F));
}
#else
// Returns the bits set in each byte, times kWeight.
template <int kWeight>
Bytes set_bits(Bytes lanes) {
  lanes -= shifted_right(lanes, 1) & bytes(0x55);
  lanes = (lanes & bytes(0x33)) + (shifted_right(lanes, 2) & bytes(0x33));
  lanes = (lanes + shifted_right(lanes, 4)) & bytes(0x0F);
  return kWeight == 2 ? lanes + lanes : lanes;
}
#endif

// Returns the bits set in the bytes of all planes. Of three planes a full adder first makes two.
template <int kPlanes>
Bytes set_bits_of_planes(const Bytes* planes) {
  if constexpr (kPlanes == 1) {
    return set_bits<1>(planes[0]);
  } else {
    const Bytes half = planes[0] ^ planes[1];
    const Bytes sum = half ^ planes[2];
    const Bytes carry = (planes[0] & planes[1]) | (half & planes[2]);
    const Bytes count = set_bits<1>(sum) + set_bits<2>(carry);
    if constexpr (kPlanes == 3) {
      return count;
    } else {
      return count + set_bits_of_planes<kPlanes - 3>(planes + 3);
    }
  }
}

template <class Keys, int kPlanes>
struct CensusCost : PackedCost<Keys> {
  using Sum = Int16s;
  static constexpr std::ptrdiff_t kPixelLanes = kLanes;
  static constexpr std::ptrdiff_t kSumLanes = kLanes;

  struct Right {
    Bytes planes[kPlanes];
  };

  explicit CensusCost(const MatchMemory& memory)
      : right_stride_(memory.right.stride), left_stride_(memory.left.stride) {}
  Right right(const std::int16_t* pixels) const {
    Right right;
    for (std::ptrdiff_t plane = 0; plane < kPlanes; ++plane)
      right.planes[plane] = load<Bytes>(pixels + plane * right_stride_);
    return right;
  }
  Sum change(const Right& right_pixels, const std::int16_t* left_pixels) const {
    Bytes differences[kPlanes];
    for (std::ptrdiff_t plane = 0; plane < kPlanes; ++plane)
      differences[plane] = right_pixels.planes[plane] ^ load<Bytes>(left_pixels + plane * left_stride_);
    return difference_of_bytes<Keys::kScale>(set_bits_of_planes<kPlanes>(differences));
  }

 private:
  std::ptrdiff_t right_stride_;
  std::ptrdiff_t left_stride_;
};

template <int kPlanes>
MatchLoops loops_of_planes(int window) {
  return window * window * 8 * kPlanes <= kLargestNarrowSum ? loops_of<CensusCost<NarrowKeys, kPlanes>>()
                                                            : loops_of<CensusCost<WideKeys, kPlanes>>();
}

MatchLoops census_loops(int planes, int window) {
  switch (planes) {
    case 1:
      return loops_of_planes<1>(window);
    case 3:
      return loops_of_planes<3>(window);
    default:
      return loops_of_planes<6>(window);
  }
}

}  // namespace
}  // namespace stereotlm::kernels::STEREOTLM_SIMD
