#include "models/area/cost_arithmetic.h"

namespace stereotlm::area {
namespace {

using kernels::CostKind;

constexpr std::int64_t kMostProduct = kMostPixel * kMostPixel;

Resources zero_test(int bits) { return {(bits + 3) / 4}; }  // 4 bits a LUT, joined by the carry chain

}  // namespace

PairArithmetic pair_arithmetic(const kernels::MatchingCost& cost) {
  switch (cost.kind) {
    case CostKind::kSad:
      break;
    case CostKind::kSsd:
      return {adder(kPixelBits + 1) + product(kPixelBits, kPixelBits), kMostProduct, kPixelBits};
    case CostKind::kZncc:
      return {product(kPixelBits, kPixelBits), kMostProduct, kPixelBits};
    case CostKind::kCensus: {
      const int bits = cost.census_bits();
      return {Resources{bits} + adder_tree(bits / 2, 2), bits, bits};
    }
  }
  return {absolute_difference(kPixelBits), kMostPixel, kPixelBits};
}

Resources census_bits(const kernels::MatchingCost& cost, bool moves_down) {
  const int before = 2 * cost.half();
  const int kept = cost.census_size * before * kPixelBits;
  const int above = before * before * kPixelBits;
  Resources bits = cost.census_bits() * comparator(kPixelBits) + registers(kept);
  if (moves_down) bits += selector(kept) + registers(above);
  return bits;
}

// By the inequality of Cauchy and Schwarz |cov| is at most the larger variance, which is largest where half
// the pixels are 0 and half are 255.
ZnccArithmetic::ZnccArithmetic(int window) {
  const std::int64_t count = std::int64_t{window} * window;
  count_bits_ = bits_of(count);
  sum_bits_ = bits_of(kMostPixel * count);
  product_bits_ = bits_of(kMostProduct * count);
  variance_bits_ = bits_of(kMostProduct * count * count / 4);
}

Resources ZnccArithmetic::variance() const {
  return product(count_bits_, product_bits_) + product(sum_bits_, sum_bits_) + adder(variance_bits_) +
         zero_test(variance_bits_) + registers(variance_bits_);
}

Resources ZnccArithmetic::score() const {
  return product(count_bits_, product_bits_) + product(sum_bits_, sum_bits_) + adder(variance_bits_ + 1) +
         selector(variance_bits_) + product(variance_bits_, variance_bits_) +
         registers(2 * variance_bits_ + 1);
}

Resources ZnccArithmetic::select() const {
  return 2 * product(2 * variance_bits_, variance_bits_) + comparator(score_bits()) + selector(score_bits());
}

}  // namespace stereotlm::area
