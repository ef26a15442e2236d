#include "models/kernels/frame_simd_keys.h"
#include "models/kernels/frame_simd_vectors.h"
#include "models/kernels/simd_loops.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {
namespace {

// Returns kScale * (lower byte - upper byte) of each lane.
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

// Returns kScale times the change of a column sum: the difference |right - left| that enters, minus the one
// that leaves.
template <int kScale>
Int16s change(Int16s right, Int16s left) {
  const auto a = reinterpret_cast<Bytes>(right);
  const auto b = reinterpret_cast<Bytes>(left);
  return difference_of_bytes<kScale>(larger(a, b) - smaller(a, b));
}

// The column sums of kCount neighbouring disparities, which lie side by side for each position. next()
// advances the pointers to the next position. Nothing points to this object, so that the compiler knows that
// no store changes its pointers.
template <int kScale, int kCount>
struct ColumnSums {
  const std::int16_t* right;
  const std::int16_t* left;
  std::int16_t* sums;

  // Adds the change at this position to the sum of the j-th disparity, and returns the new sum.
  Int16s add(Int16s right_pixels, std::ptrdiff_t j) const {
    std::int16_t* place = sums + j * kLanes;
    const Int16s sum = load<Int16s>(place) + change<kScale>(right_pixels, load<Int16s>(left + j * kLanes));
    store(sum, place);
    return sum;
  }
  void next() {
    right += kLanes;
    left += kLanes;
    sums += kCount * kLanes;
  }
};

// Matches one group of disparities along a row.
template <class Keys, int kCount>
struct Group {
  using Key = typename Keys::Key;
  using Best = typename Keys::Best;

  ColumnSums<Keys::kScale, kCount> columns;
  const std::int16_t* outside;
  Best* right_best;
  Best* left_best;
  std::ptrdiff_t window_begin;  // offset from the sums that enter the window to those that leave it
  int first;                    // first disparity of the group
  Key keys[kCount];
  Key passing[kCount];  // best keys of left windows that larger disparities of the group have yet to reach

  Group(const MatchPlan& plan, const MatchMemory& memory, int first_disparity, std::int16_t* column_sums)
      : columns{memory.right_pixels, memory.left_pixels + first_disparity * kLanes, column_sums},
        outside(memory.outside + first_disparity * kLanes),
        right_best(reinterpret_cast<Best*>(memory.right_best)),
        left_best(reinterpret_cast<Best*>(memory.left_best) + first_disparity),
        window_begin(-std::ptrdiff_t{plan.window} * kCount * kLanes),
        first(first_disparity) {
    for (int j = 0; j < kCount; ++j) {
      keys[j] = Keys::without_sum(first + j);
      passing[j] = Keys::none();
    }
  }

  void enter_first(int count) {
    for (std::ptrdiff_t u = 0; u < count; ++u) {
      const auto right = load<Int16s>(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) Keys::add(keys[j], columns.add(right, j));
      columns.next();
    }
  }

  template <bool kRightBased, bool kSomeOutside>
  void match(int count) {
    for (std::ptrdiff_t s = 0; s < count; ++s) {
      const auto right = load<Int16s>(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) {
        const auto leaving = load<Int16s>(columns.sums + window_begin + j * kLanes);
        Keys::add(keys[j], columns.add(right, j) - leaving);
      }
      columns.next();
      if (kRightBased) {
        auto least = keys[0];
        for (std::ptrdiff_t j = 0; j < kCount; ++j) {
          auto key = keys[j];
          if (kSomeOutside) key = Keys::most(key, load<Int16s>(outside + j * kLanes));
          least = j == 0 ? key : Keys::least(least, key);
        }
        *right_best = Keys::better(*right_best, least, first);
        ++right_best;
        outside += kLanes;
      }
      *left_best = Keys::better(*left_best, kCount > 1 ? Keys::least(keys[0], passing[0]) : keys[0], first);
      ++left_best;
      for (std::ptrdiff_t j = 1; j < kCount; ++j)
        passing[j - 1] = j + 1 < kCount ? Keys::least(keys[j], passing[j]) : keys[j];
    }
  }

  void leave() {
    for (std::ptrdiff_t j = 0; j + 1 < kCount; ++j)
      left_best[j] = Keys::better(left_best[j], passing[j], first);
  }
};

template <class Keys, int kCount, bool kRightBased>
void match_group(const MatchPlan& plan, const MatchMemory& memory, int first, std::int16_t* column_sums) {
  int inside = plan.first_outside - first - kCount + 1;
  if (inside < 0) inside = 0;
  const int columns = plan.columns;
  if (inside > columns || !kRightBased) inside = columns;
  Group<Keys, kCount> group(plan, memory, first, column_sums);
  group.enter_first(plan.window - 1);
  group.template match<kRightBased, false>(inside);
  group.template match<kRightBased, true>(columns - inside);
  group.leave();
}

template <int kScale, int kCount>
void add_group(const MatchPlan& plan, const MatchMemory& memory, int first, std::int16_t* column_sums) {
  ColumnSums<kScale, kCount> columns{memory.right_pixels, memory.left_pixels + first * kLanes, column_sums};
  const int positions = plan.columns + plan.window - 1;
  for (std::ptrdiff_t u = 0; u < positions; ++u) {
    const auto right = load<Int16s>(columns.right);
    for (std::ptrdiff_t j = 0; j < kCount; ++j) columns.add(right, j);
    columns.next();
  }
}

template <int kCount, class Visit>
void visit_rest(int count, int first, std::int16_t* column_sums, const Visit& visit) {
  if constexpr (kCount > 0) {
    if (count == kCount) {
      visit.template group<kCount>(first, column_sums);
    } else {
      visit_rest<kCount - 1>(count, first, column_sums, visit);
    }
  }
}

template <class Keys, class Visit>
void visit_groups(const MatchPlan& plan, const MatchMemory& memory, const Visit& visit) {
  const std::ptrdiff_t stride = (plan.columns + plan.window) * kLanes;
  // A vector of zeros stands before the sums of each disparity.
  std::int16_t* column_sums = memory.column_sums;
  int first = 0;
  for (; first + Keys::kGroup <= plan.disparities; first += Keys::kGroup) {
    visit.template group<Keys::kGroup>(first, column_sums + Keys::kGroup * kLanes);
    column_sums += Keys::kGroup * stride;
  }
  const int rest = plan.disparities - first;
  visit_rest<Keys::kGroup - 1>(rest, first, column_sums + rest * kLanes, visit);
}

template <class Keys>
struct AddGroup {
  const MatchPlan& plan;
  const MatchMemory& memory;
  template <int kCount>
  void group(int first, std::int16_t* column_sums) const {
    add_group<Keys::kScale, kCount>(plan, memory, first, column_sums);
  }
};

template <class Keys>
struct MatchGroup {
  const MatchPlan& plan;
  const MatchMemory& memory;
  template <int kCount>
  void group(int first, std::int16_t* column_sums) const {
    if (plan.right_based) {
      match_group<Keys, kCount, true>(plan, memory, first, column_sums);
    } else {
      match_group<Keys, kCount, false>(plan, memory, first, column_sums);
    }
  }
};

template <class Keys>
void store_disparities(const typename Keys::Best* best, int count, std::int16_t* out) {
  // Works in place: `out` points to the keys, which are longer than the disparities.
  for (std::ptrdiff_t p = 0; p < count; ++p) store(Keys::disparity(best[p]), out + p * kLanes);
}

template <class Keys>
void match_row_with(const MatchPlan& plan, const MatchMemory& memory) {
  auto* right = reinterpret_cast<typename Keys::Best*>(memory.right_best);
  auto* left = reinterpret_cast<typename Keys::Best*>(memory.left_best);
  const int left_positions = plan.columns + plan.disparities - 1;
  for (std::ptrdiff_t p = 0; p < plan.columns; ++p) right[p] = Keys::best_of_none();
  for (std::ptrdiff_t p = 0; p < left_positions; ++p) left[p] = Keys::best_of_none();
  visit_groups<Keys>(plan, memory, MatchGroup<Keys>{plan, memory});
  // Left windows beyond the end of a segment belong to the next segment, where their disparities are smaller.
  const auto band_begins = load<Int16s>(memory.band_begins);
  for (std::ptrdiff_t p = left_positions - 1; p >= plan.columns; --p) {
    auto& own = left[p - plan.columns];
    own = Keys::better(own, Keys::load_moved(left + p, band_begins));
  }
  store_disparities<Keys>(left, plan.columns, memory.left_best);
  if (plan.right_based) store_disparities<Keys>(right, plan.columns, memory.right_best);
}

}  // namespace

void add_row(const MatchPlan& plan, const MatchMemory& memory) {
  if (plan.window <= kLastNarrowWindow) {
    visit_groups<NarrowKeys>(plan, memory, AddGroup<NarrowKeys>{plan, memory});
  } else {
    visit_groups<WideKeys>(plan, memory, AddGroup<WideKeys>{plan, memory});
  }
}

void match_row(const MatchPlan& plan, const MatchMemory& memory) {
  if (plan.window <= kLastNarrowWindow) {
    match_row_with<NarrowKeys>(plan, memory);
  } else {
    match_row_with<WideKeys>(plan, memory);
  }
}

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
