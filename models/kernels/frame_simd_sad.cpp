#include "models/kernels/frame_simd_match.h"
#include "models/kernels/simd_loops.h"

// Sum of absolute differences.
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

template <class Keys>
struct SadCost : KeyedCost<Keys> {
  using Sum = Int16s;
  static constexpr std::ptrdiff_t kPixelLanes = kLanes;
  static constexpr std::ptrdiff_t kSumLanes = kLanes;

  SadCost(const MatchPlan& /*plan*/, const MatchMemory& /*memory*/, int /*first*/) {}
  static Int16s right(const std::int16_t* pixels) { return load<Int16s>(pixels); }
  static Sum change(Int16s right_pixels, const std::int16_t* left_pixels) {
    const auto a = reinterpret_cast<Bytes>(right_pixels);
    const auto b = load<Bytes>(left_pixels);
    return difference_of_bytes<Keys::kScale>(larger(a, b) - smaller(a, b));
  }
};

}  // namespace

MatchLoops sad_loops(int window) {
  return window * window * 255 <= kLargestNarrowSum ? loops_of<SadCost<NarrowKeys>>()
                                                    : loops_of<SadCost<WideKeys>>();
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
