#pragma once

#include "models/kernels/frame_simd_keys.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

// The loops that match one row of windows, for any cost. Column sums are kept for each disparity and
// position; a row adds the pixels that enter at the bottom and subtracts those that leave at the top. Along
// the row a window sum gains the column sum that enters and loses the one that leaves.
//
// A Cost is made from the MatchMemory. It has:
//   Keys                    how candidates are compared (frame_simd_keys.h)
//   kPixelLanes, kSumLanes  lanes of the pixels and of a column sum at one position
//   kUnpacks                whether prepare() fills MatchSide::unpacked
//   pixels(side)            the pixels of a side that right() and change() take
//   Sum                     a column sum, or its change
//   right(pixels)           loads the right pixels at a position
//   change(right, pixels)   the change of a column sum. `right`: from right(); `pixels`: of the left side
// Each disparity is part of its key from the start, so that a window sum is the key of both sides.

// The column sums of kCount neighbouring disparities, which lie side by side for each position. next()
// advances the pointers to the next position. Nothing points to this object, so that the compiler knows that
// no store changes its pointers.
template <class Cost, int kCount>
struct ColumnSums {
  using Sum = typename Cost::Sum;

  const std::int16_t* right;
  const std::int16_t* left;
  std::int16_t* sums;

  // Adds the change at this position to the sum of the j-th disparity, and returns the new sum.
  template <class Pixels>
  Sum add(const Cost& cost, const Pixels& right_pixels, std::ptrdiff_t j) const {
    std::int16_t* place = sums + j * Cost::kSumLanes;
    const Sum sum = load<Sum>(place) + cost.change(right_pixels, left + j * Cost::kPixelLanes);
    store(sum, place);
    return sum;
  }
  void next() {
    right += Cost::kPixelLanes;
    left += Cost::kPixelLanes;
    sums += kCount * Cost::kSumLanes;
  }
};

// Which left windows of a group may be outside the image, in each lane.
enum class Outside {
  kNone,
  kSome,
  kAllOrNone,
};

// Matches one group of disparities along a row.
template <class Cost, int kCount>
struct Group {
  using Keys = typename Cost::Keys;
  using Sum = typename Cost::Sum;
  using Key = typename Keys::Key;
  using Best = typename Keys::Best;

  Cost cost;
  ColumnSums<Cost, kCount> columns;
  const std::int16_t* outside;
  Best* right_best;
  Best* left_best;
  std::ptrdiff_t window_begin;  // offset from the sums that enter the window to those that leave it
  int first;                    // first disparity of the group
  Key windows[kCount];          // their sums
  Key passing[kCount];  // best keys of left windows that larger disparities of the group have yet to reach

  Group(const MatchPlan& plan, const MatchMemory& memory, int first_disparity, std::int16_t* column_sums)
      : cost(memory),
        columns{Cost::pixels(memory.right),
                Cost::pixels(memory.left) + std::ptrdiff_t{first_disparity} * Cost::kPixelLanes, column_sums},
        outside(memory.outside + first_disparity * kLanes),
        right_best(reinterpret_cast<Best*>(memory.right.best)),
        left_best(reinterpret_cast<Best*>(memory.left.best) + first_disparity),
        window_begin(-std::ptrdiff_t{plan.window} * kCount * Cost::kSumLanes),
        first(first_disparity) {
    for (int j = 0; j < kCount; ++j) {
      windows[j] = Keys::without_sum(first + j);
      passing[j] = Keys::none();
    }
  }

  // Adds the next `count` positions to the column sums, and with kToWindows these sums to the windows.
  template <bool kToWindows>
  void enter(int count) {
    for (std::ptrdiff_t u = 0; u < count; ++u) {
      const auto right = cost.right(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) {
        const auto sum = columns.add(cost, right, j);
        if constexpr (kToWindows) Keys::add(windows[j], sum);
      }
      columns.next();
    }
  }

  template <bool kRightBased, Outside kOutside>
  void match(int count) {
    for (std::ptrdiff_t s = 0; s < count; ++s) {
      const auto right = cost.right(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) {
        const auto leaving = load<Sum>(columns.sums + window_begin + j * Cost::kSumLanes);
        Keys::add(windows[j], columns.add(cost, right, j) - leaving);
      }
      columns.next();
      if (kRightBased) {
        Key best;
        for (std::ptrdiff_t j = 0; j < kCount; ++j) {
          Key key = windows[j];
          if (kOutside == Outside::kSome) key = Keys::unless(load<Int16s>(outside + j * kLanes), key);
          best = j == 0 ? key : Keys::best_of(best, key);
        }
        if (kOutside == Outside::kAllOrNone) best = Keys::unless(load<Int16s>(outside), best);
        *right_best = Keys::better(*right_best, best, first);
        ++right_best;
        outside += kLanes;
      }
      *left_best =
          Keys::better(*left_best, kCount > 1 ? Keys::best_of(passing[0], windows[0]) : windows[0], first);
      ++left_best;
      for (std::ptrdiff_t j = 1; j < kCount; ++j)
        passing[j - 1] = j + 1 < kCount ? Keys::best_of(passing[j], windows[j]) : windows[j];
    }
  }

  void leave() {
    for (std::ptrdiff_t j = 0; j + 1 < kCount; ++j)
      left_best[j] = Keys::better(left_best[j], passing[j], first);
  }
};

template <class Cost, int kCount, bool kRightBased>
void match_group(const MatchPlan& plan, const MatchMemory& memory, int first, std::int16_t* column_sums) {
  const int columns = plan.columns;
  Group<Cost, kCount> group(plan, memory, first, column_sums);
  group.template enter<true>(plan.window - 1);
  int matched = 0;  // positions
  const auto until = [&](int end) {
    const int begin = matched;
    if (matched < end) matched = end < columns ? end : columns;
    return matched - begin;
  };
  // The first position at which all left windows of the last segment are outside. Those of the segment before
  // it follow `columns` positions later.
  int outside = plan.first_outside - first;
  if (!kRightBased) outside = columns + kCount;
  group.template match<kRightBased, Outside::kNone>(until(outside - kCount + 1));
  while (matched < columns) {
    group.template match<kRightBased, Outside::kSome>(until(outside));
    group.template match<kRightBased, Outside::kAllOrNone>(until(outside + columns - kCount + 1));
    outside += columns;
  }
  group.leave();
}

template <int kCount>
struct Count {
  static constexpr int value = kCount;
};

template <int kCount, class Visit>
void visit_rest(int count, int first, std::int16_t* column_sums, const Visit& visit) {
  if constexpr (kCount > 0) {
    if (count == kCount) {
      visit(Count<kCount>{}, first, column_sums);
    } else {
      visit_rest<kCount - 1>(count, first, column_sums, visit);
    }
  }
}

// visit(Count, first, column_sums): a group of disparities, the first one of them, and their column sums.
template <class Cost, class Visit>
void visit_groups(const MatchPlan& plan, const MatchMemory& memory, const Visit& visit) {
  const std::ptrdiff_t stride = (plan.columns + plan.window) * Cost::kSumLanes;
  // A sum of zero stands before the sums of each disparity.
  std::int16_t* column_sums = memory.column_sums;
  constexpr int kGroup = Cost::Keys::kGroup;
  int first = 0;
  for (; first + kGroup <= plan.disparities; first += kGroup) {
    visit(Count<kGroup>{}, first, column_sums + kGroup * Cost::kSumLanes);
    column_sums += kGroup * stride;
  }
  const int rest = plan.disparities - first;
  visit_rest<kGroup - 1>(rest, first, column_sums + rest * Cost::kSumLanes, visit);
}

// MatchLoops::add_row and match_row.
template <class Cost>
void add_row_with(const MatchPlan& plan, const MatchMemory& memory) {
  Cost::prepare(plan, memory);
  visit_groups<Cost>(plan, memory, [&](auto count, int first, std::int16_t* column_sums) {
    Group<Cost, decltype(count)::value> group(plan, memory, first, column_sums);
    group.template enter<false>(plan.columns + plan.window - 1);
  });
}

template <class Cost>
void match_row_with(const MatchPlan& plan, const MatchMemory& memory) {
  using Keys = typename Cost::Keys;
  Cost::prepare(plan, memory);
  auto* right = reinterpret_cast<typename Keys::Best*>(memory.right.best);
  auto* left = reinterpret_cast<typename Keys::Best*>(memory.left.best);
  const int left_positions = plan.columns + plan.disparities - 1;
  for (std::ptrdiff_t p = 0; p < plan.columns; ++p) right[p] = Keys::best_of_none();
  for (std::ptrdiff_t p = 0; p < left_positions; ++p) left[p] = Keys::best_of_none();
  visit_groups<Cost>(plan, memory, [&](auto count, int first, std::int16_t* column_sums) {
    constexpr int kCount = decltype(count)::value;
    if (plan.right_based) {
      match_group<Cost, kCount, true>(plan, memory, first, column_sums);
    } else {
      match_group<Cost, kCount, false>(plan, memory, first, column_sums);
    }
  });
  // Left windows beyond the end of a segment belong to the next segment, where their disparities are smaller.
  const auto band_begins = load<Int16s>(memory.band_begins);
  for (std::ptrdiff_t p = left_positions - 1; p >= plan.columns; --p) {
    auto& own = left[p - plan.columns];
    own = Keys::better(own, Keys::load_moved(left + p, band_begins));
  }
  // In place: the keys are longer than the disparities.
  for (std::ptrdiff_t p = 0; p < plan.columns; ++p)
    store(Keys::disparity(left[p]), memory.left.best + p * kLanes);
  for (std::ptrdiff_t p = 0; plan.right_based && p < plan.columns; ++p)
    store(Keys::disparity(right[p]), memory.right.best + p * kLanes);
}

template <class Cost>
constexpr MatchLoops loops_of() {
  return {int{Cost::kSumLanes / kLanes}, static_cast<int>(sizeof(typename Cost::Keys::Best) / kBytes),
          Cost::kUnpacks, add_row_with<Cost>, match_row_with<Cost>};
}

// Returns kScale * (lower byte - upper byte) of each lane. The bytes must be small enough for 16 bits.
template <int kScale>
Int16s difference_of_bytes(Bytes bytes) {
#if defined(__AVX512BW__)
  const Int16s weights = int16s((kScale & 0xFF) - kScale * 256);
  return reinterpret_cast<Int16s>(
      _mm512_maddubs_epi16(reinterpret_cast<__m512i>(bytes), reinterpret_cast<__m512i>(weights)));
#elif defined(__AVX2__)
  const Int16s weights = int16s((kScale & 0xFF) - kScale * 256);
  return reinterpret_cast<Int16s>(
      _mm256_maddubs_epi16(reinterpret_cast<__m256i>(bytes), reinterpret_cast<__m256i>(weights)));
#else
  const auto lanes = reinterpret_cast<Int16s>(bytes);
  return ((lanes & 0xFF) - (lanes >> 8 & 0xFF)) * static_cast<std::int16_t>(kScale);
#endif
}

// Stores the pixels of even lanes and those of odd lanes as pairs of 16 bits: the pixel that enters the
// window times kEntering, and the pixel that leaves it times kLeaving.
template <int kEntering, int kLeaving>
void unpack(const std::int16_t* pixels, int positions, std::int16_t* out) {
  const auto factors = reinterpret_cast<Int16s>(int32s((kEntering & 0xFFFF) + kLeaving * 65536));
  for (std::ptrdiff_t p = 0; p < positions; ++p) {
    const auto bytes = load<Int32s>(pixels + p * kLanes);
    const Int32s even = (bytes & 0xFF) | (bytes & 0xFF00) << 8;
    const Int32s odd = (bytes >> 16 & 0xFF) | (bytes >> 8 & 0xFF0000);
    store(reinterpret_cast<Int16s>(even) * factors, out + 2 * p * kLanes);
    store(reinterpret_cast<Int16s>(odd) * factors, out + (2 * p + 1) * kLanes);
  }
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
