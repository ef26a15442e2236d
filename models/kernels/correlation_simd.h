#pragma once

#include "models/kernels/simd_vectors.h"

// The loops of CorrelationMatcher (Simd).
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

constexpr int kInt32s = kBytes / 4;   // 32-bit values in a vector
constexpr int kDoubles = kBytes / 8;  // doubles in a vector

using QuarterVectorBytes = std::uint8_t __attribute__((vector_size(kBytes / 4)));
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
// their value. So the quotients of equal scores differ by less than 2^-50 of their value. A candidate is near
// if its quotient is at most 2^-49 of the greatest one below it, so that every candidate with the greatest
// score is near. Near candidates with the same variance have the same covariance, because covariances are
// integers below 2^34. If all near candidates have the same variance, their scores are equal. Otherwise they
// are compared as fractions, exactly.
int best_candidate(const Candidates& candidates, const std::int32_t* products, double pixels, double own_sum,
                   double* quotients) {
  const double lowest = -__builtin_inf();
  Doubles first_lanes{};
  for (int i = 0; i < kDoubles; ++i) first_lanes[i] = i;
  Doubles greatest = Doubles{} + lowest;
  for (int c = 0; c < candidates.count; c += kDoubles) {
    const Doubles covariance =
        pixels * to_doubles(load<HalfInt32s>(products + c)) - own_sum * load<Doubles>(candidates.sums + c);
    const auto absolute = reinterpret_cast<Doubles>(reinterpret_cast<Int64s>(covariance) & INT64_MAX);
    Doubles quotient = covariance * absolute * load<Doubles>(candidates.inverses + c);
    if (c + kDoubles > candidates.count)
      quotient = first_lanes < candidates.count - c ? quotient : Doubles{} + lowest;
    store(quotient, quotients + c);
    greatest = larger(greatest, quotient);
  }
  double best_quotient = greatest[0];
  for (int i = 1; i < kDoubles; ++i)
    best_quotient = greatest[i] > best_quotient ? greatest[i] : best_quotient;
  const double least_near = best_quotient - __builtin_fabs(best_quotient) * 0x1p-49;

  int best = 0;
  while (quotients[best] < least_near) ++best;
  Int64s is_unlike{};  // negative where a near candidate has another variance
  for (int c = 0; c < candidates.count; c += kDoubles) {
    is_unlike |= (load<Doubles>(quotients + c) >= least_near) &
                 (load<Doubles>(candidates.inverses + c) != candidates.inverses[best]);
  }
  std::int64_t any = 0;
  for (int i = 0; i < kDoubles; ++i) any |= is_unlike[i];
  if (any == 0) return best;

  __extension__ using Wide = __int128;
  const auto square = [&](int c) -> Wide {
    const Wide covariance = static_cast<std::int64_t>(pixels * products[c] - own_sum * candidates.sums[c]);
    return covariance < 0 ? -covariance * covariance : covariance * covariance;
  };
  for (int c = best + 1; c < candidates.count; ++c) {
    if (quotients[c] >= least_near &&
        square(c) * candidates.variances[best] > square(best) * candidates.variances[c])
      best = c;
  }
  return best;
}

}  // namespace
}  // namespace stereotlm::kernels::STEREOTLM_SIMD
