#pragma once

#include "models/kernels/frame_simd_match.h"

// Zero-mean normalised cross-correlation. The score of a candidate is cov * |cov| / (var_r * var_l). For a
// right window var_r is common to all candidates, so that cov * |cov| / var_l is compared; for a left window
// cov * |cov| / var_r.
//
// These quotients are computed as floats. Windows whose best candidate is not certain are marked undecided,
// for an exact comparison:
// - The sums of products of pixels, N * sum and cov are integers of less than 53 bits, exact as doubles.
// - cov as a float, its square, 1 / var and their product are each rounded by at most 2^-24 of the value, and
//   cov enters twice: a quotient is off by less than 2^-21 of its value. It neither overflows nor underflows:
//   cov and var are below 2^34; where one of them is 0, the quotient is exactly 0.
// - A key holds the upper 24 bits of the quotient, of which 15 are of the mantissa. One step of these bits is
//   at least 2^-16 of the value. If two keys differ by two steps or more, at least one whole step lies
//   between their quotients. Their errors are smaller than this step, so their order is certain.
// - The quotient 0 is exact. Of equal zeros the smaller disparity has the greater key.
// - The bits of negative floats are in the reverse order: a window that has only negative quotients is
//   undecided.
namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

using Floats = float __attribute__((vector_size(kBytes)));
using HalfFloats = float __attribute__((vector_size(kBytes / 2)));

// Values of 32-bit lanes as doubles: of the lower and of the upper half of the lanes.
struct DoublePair {
  Doubles lower;
  Doubles upper;
};

DoublePair doubles_of(Int32s lanes) {
#if defined(__AVX512BW__)
  const HalfInt32s lower = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3, 4, 5, 6, 7);
  const HalfInt32s upper = __builtin_shufflevector(lanes, lanes, 8, 9, 10, 11, 12, 13, 14, 15);
#elif defined(__AVX2__)
  const HalfInt32s lower = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3);
  const HalfInt32s upper = __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
#else
  const HalfInt32s lower = __builtin_shufflevector(lanes, lanes, 0, 1);
  const HalfInt32s upper = __builtin_shufflevector(lanes, lanes, 2, 3);
#endif
  return {to_doubles(lower), to_doubles(upper)};
}

Floats floats_of(const DoublePair& values) {
  const auto lower = __builtin_convertvector(values.lower, HalfFloats);
  const auto upper = __builtin_convertvector(values.upper, HalfFloats);
#if defined(__AVX512BW__)
  return __builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif defined(__AVX2__)
  return __builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return __builtin_shufflevector(lower, upper, 0, 1, 2, 3);
#endif
}

// The greatest key is the best: the upper 24 bits of a quotient, then 255 - disparity.
struct QuotientKeys {
  using Key = Int32Pair;
  struct Kept {
    Key best;
    Key second;  // the best of the others
  };
  using Best = Kept;

  static Key smallest() { return {int32s(-0x7FFF0000), int32s(-0x7FFF0000)}; }
  static Key greater(const Key& a, const Key& b) { return {larger(a.even, b.even), larger(a.odd, b.odd)}; }
  static Key lesser(const Key& a, const Key& b) { return {smaller(a.even, b.even), smaller(a.odd, b.odd)}; }

  static Kept none() { return {smallest(), smallest()}; }
  static Kept only(const Key& key) { return {key, smallest()}; }
  static Kept best_of(const Kept& a, const Key& b) {
    return {greater(a.best, b), greater(a.second, lesser(a.best, b))};
  }
  static Key unless(Int16s outside, const Key& key) {
    return {smaller(key.even, ~(even_lanes(outside) << 16)), smaller(key.odd, ~(odd_lanes(outside) << 16))};
  }
  static Kept unless(Int16s outside, const Kept& kept) {
    return {unless(outside, kept.best), unless(outside, kept.second)};
  }
  static Best best_of_none() { return none(); }
  static Best better(const Best& a, const Best& b) {
    return {greater(a.best, b.best), greater(greater(a.second, b.second), lesser(a.best, b.best))};
  }
  static Best better(const Best& a, const Kept& b, int /*group*/) { return better(a, b); }
  static Best load_moved(const Best* best, Int16s outside) {
    const auto moved = [outside](const Key& key) {
      const auto* lanes = reinterpret_cast<const std::int32_t*>(&key);
      return unless(outside, Key{load<Int32s>(lanes + kLanes / 2 - 1), key.even});
    };
    return {moved(best->best), moved(best->second)};
  }
  static Int32s disparity(Int32s best, Int32s second) {
    const Int32s quotient = best >> 8;
    const Int32s is_certain = (quotient == 0) | ((quotient > 0) & (quotient - (second >> 8) > 1));
    return is_certain ? 255 - (best & 0xFF) : int32s(kUndecided);
  }
  static Int16s disparity(const Best& kept) {
    return join_lanes(disparity(kept.best.even, kept.second.even), disparity(kept.best.odd, kept.second.odd));
  }
};

// Sums over the pixels of one column, for each position.
struct ColumnStatistics {
  Int32Pair pixels;
  Int32Pair squares;
};

// Of one window, for each position.
struct WindowStatistics {
  DoublePair even;  // sums of the pixels
  DoublePair odd;
  Floats even_inverse;  // 1 / var, or 0 where var is 0
  Floats odd_inverse;
};
static_assert(sizeof(ColumnStatistics) == kColumnStatisticsVectors * kBytes);
static_assert(sizeof(WindowStatistics) == kWindowStatisticsVectors * kBytes);

Floats inverse_variance(Int32s squares, const DoublePair& sums, double pixels) {
  const DoublePair sum_of_squares = doubles_of(squares);
  const auto inverse = [pixels](Doubles sum, Doubles of_squares) {
    const Doubles variance = pixels * of_squares - sum * sum;
    return variance > 0 ? 1 / variance : Doubles{};
  };
  return floats_of({inverse(sums.lower, sum_of_squares.lower), inverse(sums.upper, sum_of_squares.upper)});
}

// Moves the column sums of one side one row down. With `windows` it also computes the statistics of its
// windows. `kLeaving`: the sign with which leaving pixels are unpacked.
template <int kLeaving>
void add_statistics(const MatchPlan& plan, const std::int16_t* unpacked, int windows, std::int16_t* columns,
                    std::int16_t* windows_out) {
  auto* column = reinterpret_cast<ColumnStatistics*>(columns);
  auto* out = reinterpret_cast<WindowStatistics*>(windows_out);
  const double pixels = plan.window * plan.window;
  Int32Pair sum{};
  Int32Pair squares{};
  for (std::ptrdiff_t p = 0; p < windows + plan.window - 1; ++p, ++column, unpacked += 2 * kLanes) {
    const auto add = [](Int16s pair, Int32s& of_pixels, Int32s& of_squares) {
      const Int16s signed_pair = pair * entering_minus_leaving();
      of_pixels += multiply_pairs(kLeaving < 0 ? pair : signed_pair, int16s(1));
      of_squares += multiply_pairs(pair, signed_pair);
    };
    add(load<Int16s>(unpacked), column->pixels.even, column->squares.even);
    add(load<Int16s>(unpacked + kLanes), column->pixels.odd, column->squares.odd);
    if (out == nullptr) continue;
    sum = sum + column->pixels;
    squares = squares + column->squares;
    if (p >= plan.window) {
      sum = sum - column[-plan.window].pixels;
      squares = squares - column[-plan.window].squares;
    }
    if (p < plan.window - 1) continue;
    out->even = doubles_of(sum.even);
    out->odd = doubles_of(sum.odd);
    out->even_inverse = inverse_variance(squares.even, out->even, pixels);
    out->odd_inverse = inverse_variance(squares.odd, out->odd, pixels);
    ++out;
  }
}

struct ZnccCost {
  using Keys = QuotientKeys;
  using Sum = Int32Pair;
  using WindowSum = Int32Pair;  // of the products of the pixels
  struct Score {                // cov * |cov|
    Floats even;
    Floats odd;
  };
  static constexpr int kGroup = 2;
  static constexpr std::ptrdiff_t kPixelLanes = 2 * kLanes;
  static constexpr std::ptrdiff_t kSumLanes = 2 * kLanes;
  static constexpr bool kUnpacks = true;
  static constexpr bool kHasStatistics = true;

  ZnccCost(const MatchPlan& plan, const MatchMemory& memory, int first)
      : right_window_(reinterpret_cast<const WindowStatistics*>(memory.right.windows)),
        left_window_(reinterpret_cast<const WindowStatistics*>(memory.left.windows) + first),
        pixels_(plan.window * plan.window),
        first_(first) {}
  static void prepare(const MatchPlan& plan, const MatchMemory& memory, bool match) {
    const int positions = plan.columns + plan.window - 1;
    unpack<1, 1>(memory.right.pixels, positions, memory.right.unpacked);
    unpack<1, -1>(memory.left.pixels, positions + plan.disparities - 1, memory.left.unpacked);
    add_statistics<1>(plan, memory.right.unpacked, plan.columns, memory.right.columns,
                      match ? memory.right.windows : nullptr);
    add_statistics<-1>(plan, memory.left.unpacked, plan.columns + plan.disparities - 1, memory.left.columns,
                       match ? memory.left.windows : nullptr);
  }
  static const std::int16_t* pixels(const MatchSide& side) { return side.unpacked; }

  static PixelPairs right(const std::int16_t* pixels) { return load_pairs(pixels); }
  static Sum change(const PixelPairs& right_pixels, const std::int16_t* left_pixels) {
    return {multiply_pairs(right_pixels.even, load<Int16s>(left_pixels)),
            multiply_pairs(right_pixels.odd, load<Int16s>(left_pixels + kLanes))};
  }

  static WindowSum start(int /*disparity*/) { return {Int32s{}, Int32s{}}; }
  static void add(WindowSum& window, const Sum& sum) { window = window + sum; }
  Score score(const WindowSum& products, std::ptrdiff_t j) const {
    return {score(products.even, right_window_->even, left_window_[j].even),
            score(products.odd, right_window_->odd, left_window_[j].odd)};
  }
  Int32Pair right_key(const Score& score, std::ptrdiff_t j) const { return key(score, left_window_[j], j); }
  Int32Pair left_key(const Score& score, std::ptrdiff_t j) const { return key(score, *right_window_, j); }
  void next() {
    ++right_window_;
    ++left_window_;
  }

 private:
  Floats score(Int32s products, const DoublePair& right_sums, const DoublePair& left_sums) const {
    const DoublePair sums = doubles_of(products);
    const Floats covariance = floats_of({pixels_ * sums.lower - right_sums.lower * left_sums.lower,
                                         pixels_ * sums.upper - right_sums.upper * left_sums.upper});
    return covariance * reinterpret_cast<Floats>(reinterpret_cast<Int32s>(covariance) & 0x7FFFFFFF);
  }
  Int32Pair key(const Score& score, const WindowStatistics& other, std::ptrdiff_t j) const {
    const Int32s disparity = int32s(255 - first_ - static_cast<int>(j));
    return {(reinterpret_cast<Int32s>(score.even * other.even_inverse) & ~0xFF) | disparity,
            (reinterpret_cast<Int32s>(score.odd * other.odd_inverse) & ~0xFF) | disparity};
  }

  const WindowStatistics* right_window_;
  const WindowStatistics* left_window_;
  double pixels_;
  int first_;
};

MatchLoops zncc_loops(int /*window*/) { return loops_of<ZnccCost>(); }

}  // namespace
}  // namespace stereotlm::kernels::STEREOTLM_SIMD
