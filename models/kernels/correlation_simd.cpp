#include "models/kernels/correlation_simd.h"

#include "models/kernels/frame_simd_vectors.h"
#include "models/kernels/simd_loops.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

constexpr int kInt32s = kBytes / 4;   // 32-bit values in a vector
constexpr int kDoubles = kBytes / 8;  // doubles in a vector

using QuarterVectorBytes = std::uint8_t __attribute__((vector_size(kBytes / 4)));
using Uint64s = std::uint64_t __attribute__((vector_size(kBytes)));
using Int64s = std::int64_t __attribute__((vector_size(kBytes)));

// By an intrinsic, because GCC's own conversion takes several instructions.
Int32s widened(const std::uint8_t* bytes) {
#if defined(__AVX512BW__)
  return reinterpret_cast<Int32s>(_mm512_maskz_cvtepu8_epi32(0xFFFF, load<__m128i>(bytes)));
#elif defined(__AVX2__)
  return reinterpret_cast<Int32s>(
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes))));
#else
  return __builtin_convertvector(load<QuarterVectorBytes>(bytes), Int32s);
#endif
}

Doubles doubles(double value) { return Doubles{} + value; }
Doubles absolute(Doubles values) {
  return reinterpret_cast<Doubles>(reinterpret_cast<Int64s>(values) & 0x7FFFFFFFFFFFFFFF);
}

double greatest_of(Doubles values) {
  double greatest = values[0];
  for (int i = 1; i < kDoubles; ++i) greatest = values[i] > greatest ? values[i] : greatest;
  return greatest;
}

double least_of(Doubles values) { return -greatest_of(-values); }

bool any(Int64s lanes) {
  std::int64_t all = 0;
  for (int i = 0; i < kDoubles; ++i) all |= lanes[i];
  return all != 0;
}

// The integers in these doubles, which are below 2^51.
Uint64s uint64s(Doubles values) {
  const Doubles shift = doubles(0x1.8p52);
  return reinterpret_cast<Uint64s>(values + shift) - reinterpret_cast<Uint64s>(shift);
}

constexpr double kInfinity = __builtin_inf();

}  // namespace

void add_products(const std::uint8_t* const* rows, const std::int16_t* own, int pairs, int lanes,
                  std::int32_t* column, const std::int32_t* leaving, std::int32_t* window) {
  for (int c = 0; c < lanes; c += kInt32s) {
    auto sums = load<Int32s>(column + c);
    for (int row = 0; row < 2 * pairs; row += 2) {
      const Int32s pixels = widened(rows[row] + c) | widened(rows[row + 1] + c) << 16;
      const auto own_pixels = Int32s{} + load<std::int32_t>(own + row);
      sums += multiply_pairs(reinterpret_cast<Int16s>(pixels), reinterpret_cast<Int16s>(own_pixels));
    }
    store(sums, column + c);
    store(load<Int32s>(window + c) + sums - load<Int32s>(leaving + c), window + c);
  }
}

// The quotients covariance * |covariance| / variance are rounded three times, each time by at most 2^-53 of
// their value: those of equal scores differ by less than 2^-50. A candidate is near if its quotient is less
// than 2^-49 below the greatest one, so that every candidate with the greatest score is near. Near candidates
// with the same variance have the same covariance, because covariances are integers below 2^34. If all near
// candidates have one variance, their scores are equal. Otherwise they are compared as fractions: their cross
// products differ by less than 2^56, so that the lowest 64 bits of the difference suffice.
int best_candidate(const Candidates& candidates, const std::int32_t* products, double pixels, double own_sum,
                   double* quotients) {
  Doubles first_lanes{};
  for (int i = 0; i < kDoubles; ++i) first_lanes[i] = i;
  const auto covariances = [=](int c) {
    return pixels * to_doubles(load<HalfInt32s>(products + c)) - own_sum * load<Doubles>(candidates.sums + c);
  };
  Doubles greatest = doubles(-kInfinity);
  for (int c = 0; c < candidates.count; c += kDoubles) {
    const Doubles covariance = covariances(c);
    Doubles quotient = covariance * absolute(covariance) * load<Doubles>(candidates.inverses + c);
    if (c + kDoubles > candidates.count)
      quotient = first_lanes < candidates.count - c ? quotient : doubles(-kInfinity);
    store(quotient, quotients + c);
    greatest = larger(greatest, quotient);
  }
  const double best_quotient = greatest_of(greatest);
  const double least_near = best_quotient - __builtin_fabs(best_quotient) * 0x1p-49;

  int best = 0;
  while (quotients[best] < least_near) ++best;
  Int64s is_unlike{};  // negative where a near candidate has another variance
  for (int c = 0; c < candidates.count; c += kDoubles) {
    is_unlike += (load<Doubles>(quotients + c) >= least_near) &
                 (load<Doubles>(candidates.inverses + c) != candidates.inverses[best]);
  }
  if (!any(is_unlike)) return best;

  for (;;) {
    const auto best_variance = static_cast<std::uint64_t>(candidates.variances[best]);
    const auto best_covariance =
        static_cast<std::int64_t>(pixels * products[best] - own_sum * candidates.sums[best]);
    const auto best_square =
        static_cast<std::uint64_t>(best_covariance) *
        static_cast<std::uint64_t>(best_covariance < 0 ? -best_covariance : best_covariance);
    Doubles numbers = first_lanes;
    Doubles first = doubles(kInfinity);
    for (int c = 0; c < candidates.count; c += kDoubles, numbers += kDoubles) {
      const auto is_near = load<Doubles>(quotients + c) >= least_near;
      const Doubles covariance = covariances(c);
      const Uint64s square = uint64s(covariance) * uint64s(absolute(covariance));
      const Uint64s difference =
          square * best_variance - best_square * load<Uint64s>(candidates.variances + c);
      const auto is_better = is_near & (reinterpret_cast<Int64s>(difference) > 0);
      first = smaller(first, is_better ? numbers : doubles(kInfinity));
    }
    const double better = least_of(first);
    if (better == kInfinity) return best;
    best = static_cast<int>(better);
  }
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
