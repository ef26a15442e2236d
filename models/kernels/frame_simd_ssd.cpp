#include "models/kernels/frame_simd_match.h"
#include "models/kernels/simd_loops.h"

// Sum of squared differences. The pixels are multiplied by kFactor first, so that the sums have the scale of
// the keys.
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

struct PixelPairs {
  Int16s even;
  Int16s odd;
};

template <class Keys, int kFactor>
struct SsdCost : KeyedCost<Keys> {
  static_assert(kFactor * kFactor == Keys::kSumScale);
  using Sum = Int32Pair;
  static constexpr std::ptrdiff_t kPixelLanes = 2 * kLanes;
  static constexpr std::ptrdiff_t kSumLanes = 2 * kLanes;
  static constexpr bool kUnpacks = true;

  SsdCost(const MatchPlan& /*plan*/, const MatchMemory& /*memory*/, int /*first*/) {}
  static void prepare(const MatchPlan& plan, const MatchMemory& memory, bool /*match*/) {
    const int positions = plan.columns + plan.window - 1;
    unpack<kFactor, kFactor>(memory.right_pixels, positions, memory.right_unpacked);
    unpack<kFactor, kFactor>(memory.left_pixels, positions + plan.disparities - 1, memory.left_unpacked);
  }
  static const std::int16_t* right_pixels(const MatchMemory& memory) { return memory.right_unpacked; }
  static const std::int16_t* left_pixels(const MatchMemory& memory) { return memory.left_unpacked; }

  static PixelPairs right(const std::int16_t* pixels) {
    return {load<Int16s>(pixels), load<Int16s>(pixels + kLanes)};
  }
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

}  // namespace

MatchLoops ssd_loops(int window) {
  return window * window <= kLargestWideSum / (255 * 255) ? loops_of<SsdCost<WideKeys, 16>>()
                                                          : loops_of<SsdCost<WideGroupKeys, 2>>();
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
