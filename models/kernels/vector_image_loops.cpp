// Compiled once per instruction set STEREOTLM_INSTRUCTION_SET, whose table of loops is STEREOTLM_IMAGE_LOOPS.
// What is defined here must not leave this file, or the linker could choose it for machines that cannot run
// it: so no function of the standard library, and everything but the table of loops in an unnamed namespace.
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "models/kernels/image_loops.h"

namespace stereotlm::kernels {
namespace {

#if defined(__AVX512BW__)
constexpr int kBytes = 64;
#elif defined(__AVX2__)
constexpr int kBytes = 32;
#else
constexpr int kBytes = 16;
#endif
constexpr std::ptrdiff_t kLanes = kBytes / 2;
static_assert(kBytes <= kMostImageVectorBytes);

using Bytes = std::uint8_t __attribute__((vector_size(kBytes)));
using Halves = std::int16_t __attribute__((vector_size(kBytes)));
using Words = std::int32_t __attribute__((vector_size(kBytes)));
using HalfBytes = std::uint8_t __attribute__((vector_size(kBytes / 2)));

template <class Vector>
Vector load(const void* from) {
  Vector vector;
  __builtin_memcpy(&vector, from, sizeof vector);
  return vector;
}

template <class Vector>
void store(const Vector& vector, void* to) {
  __builtin_memcpy(to, &vector, sizeof vector);
}

template <class Vector>
Vector smaller(Vector a, Vector b) {
  return a < b ? a : b;
}

template <class Vector>
Vector larger(Vector a, Vector b) {
  return a > b ? a : b;
}

Halves halves(int value) { return Halves{} + static_cast<std::int16_t>(value); }
Words words(int value) { return Words{} + value; }

// Even and odd lanes as 32-bit ones.
Words even_lanes(Halves lanes) { return reinterpret_cast<Words>(lanes) << 16 >> 16; }
Words odd_lanes(Halves lanes) { return reinterpret_cast<Words>(lanes) >> 16; }
Halves join_lanes(Words even, Words odd) { return reinterpret_cast<Halves>((even & 0xFFFF) | odd << 16); }

// Sums of the products of neighbours.
Words multiply_pairs(Halves a, Halves b) {
#if defined(__AVX512BW__)
  return reinterpret_cast<Words>(
      _mm512_madd_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
#elif defined(__AVX2__)
  return reinterpret_cast<Words>(
      _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<Words>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return even_lanes(a) * even_lanes(b) + odd_lanes(a) * odd_lanes(b);
#endif
}

// kScale * (lower byte - upper byte) of each lane.
template <int kScale>
Halves difference_of_bytes(Bytes bytes) {
#if defined(__AVX512BW__)
  const Halves weights = halves((kScale & 0xFF) - kScale * 256);
  return reinterpret_cast<Halves>(
      _mm512_maddubs_epi16(reinterpret_cast<__m512i>(bytes), reinterpret_cast<__m512i>(weights)));
#elif defined(__AVX2__)
  const Halves weights = halves((kScale & 0xFF) - kScale * 256);
  return reinterpret_cast<Halves>(
      _mm256_maddubs_epi16(reinterpret_cast<__m256i>(bytes), reinterpret_cast<__m256i>(weights)));
#else
  const auto lanes = reinterpret_cast<Halves>(bytes);
  return ((lanes & 0xFF) - (lanes >> 8 & 0xFF)) * static_cast<std::int16_t>(kScale);
#endif
}

// kScale * (what enters - what leaves), |right pixel - left pixel| each.
template <int kScale>
Halves change(Halves right, Halves left) {
  const auto a = reinterpret_cast<Bytes>(right);
  const auto b = reinterpret_cast<Bytes>(left);
  return difference_of_bytes<kScale>(larger(a, b) - smaller(a, b));
}

// ---- rectify, filter ----

void rectify(const std::uint8_t* source, const std::uint32_t* table, int count, int width,
             std::uint8_t* out) {
  // An entry is a pair of 16-bit numbers, column and row with the valid bit above it.
  const auto weights = reinterpret_cast<Halves>(words(width << 16 | 1));
  constexpr int kChunk = 512;
  alignas(kBytes) std::uint32_t places[kChunk];
  for (; count > 0; count -= kChunk, table += kChunk, out += kChunk) {
    const int pixels = count < kChunk ? count : kChunk;
    std::ptrdiff_t i = 0;
    for (; i + kLanes / 2 <= pixels; i += kLanes / 2) {
      const auto entries = load<Words>(table + i);
      store(multiply_pairs(reinterpret_cast<Halves>(entries & entries >> 31 & 0x7FF07FF), weights),
            places + i);
    }
    for (; i < pixels; ++i) {
      const std::uint32_t entry = table[i] >> 31 != 0 ? table[i] : 0;
      places[i] = (entry >> 16 & 0x7FF) * static_cast<std::uint32_t>(width) + (entry & 0x7FF);
    }
    for (i = 0; i < pixels; ++i) out[i] = source[places[i]];
    for (i = 0; i < pixels; ++i) out[i] &= static_cast<std::uint8_t>(table[i] >> 31 != 0 ? 0xFF : 0);
  }
}

// The sum of two rows, the second of which may be none, in `out`, or added to what is there.
template <bool kMore, bool kSecond>
void add_two_rows(const std::uint8_t* first, const std::uint8_t* second, int width, std::int16_t* out) {
  std::ptrdiff_t u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    Halves sum = __builtin_convertvector(load<HalfBytes>(first + u), Halves);
    if (kSecond) sum += __builtin_convertvector(load<HalfBytes>(second + u), Halves);
    if (kMore) sum += load<Halves>(out + u);
    store(sum, out + u);
  }
  for (; u < width; ++u)
    out[u] = static_cast<std::int16_t>(first[u] + (kSecond ? second[u] : 0) + (kMore ? out[u] : 0));
}

void add_rows(const std::uint8_t* const* rows, int count, int width, std::int16_t* out) {
  if (count == 1) {
    add_two_rows<false, false>(rows[0], nullptr, width, out);
  } else {
    add_two_rows<false, true>(rows[0], rows[1], width, out);
  }
  for (int row = 2; row + 1 < count; row += 2) add_two_rows<true, true>(rows[row], rows[row + 1], width, out);
  if (count > 2 && count % 2 != 0) add_two_rows<true, false>(rows[count - 1], nullptr, width, out);
}

Words level(Words sum, int shift) { return larger(smaller(sum >> shift, words(127)), words(-128)) + 128; }

void filter_row(const std::int16_t* const* rows, const FilterTaps& taps, int width, std::uint8_t* out) {
  constexpr int kVectors = 2;
  for (std::ptrdiff_t u = 0; u < width; u += kVectors * kLanes) {
    // Pairs of columns that begin at even and at odd positions.
    Words even[kVectors] = {};
    Words odd[kVectors] = {};
    const std::int32_t* weight = taps.weights;
    for (int row = 0; row < taps.rows; ++row) {
      const std::int16_t* pixels = rows[row] + u;
      for (int pair = 0; pair < taps.pairs; ++pair, pixels += 2) {
        const auto weights = reinterpret_cast<Halves>(words(*weight++));
        for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
          even[v] += multiply_pairs(load<Halves>(pixels + v * kLanes), weights);
          odd[v] += multiply_pairs(load<Halves>(pixels + v * kLanes + 1), weights);
        }
      }
    }
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      const Halves levels = join_lanes(level(even[v], taps.shift), level(odd[v], taps.shift));
      store(__builtin_convertvector(levels, HalfBytes), out + u + v * kLanes);
    }
  }
}

// ---- match ----

void pair_pixels(const std::uint8_t* entering, const std::uint8_t* leaving, int width, std::int16_t* out) {
  for (std::ptrdiff_t i = 0; i < width; ++i)
    out[i] = static_cast<std::int16_t>(entering[i] | leaving[i] << 8);
}

// Blocks of 8 x 8 lanes of 16 bit, whatever the instruction set.
constexpr std::ptrdiff_t kBlock = 8;
using Block8 = std::uint8_t __attribute__((vector_size(8)));
using Block16 = std::int16_t __attribute__((vector_size(16)));
using Block32 = std::int32_t __attribute__((vector_size(16)));
using Block64 = std::int64_t __attribute__((vector_size(16)));

void transpose(Block16 (&rows)[kBlock]) {
  Block16 a[kBlock];
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    a[2 * i] = __builtin_shufflevector(rows[i], rows[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    a[2 * i + 1] = __builtin_shufflevector(rows[i], rows[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
  Block16 b[kBlock];
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    b[2 * i] = __builtin_shufflevector(a[i], a[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    b[2 * i + 1] = __builtin_shufflevector(a[i], a[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    rows[2 * i] = __builtin_shufflevector(b[i], b[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
    rows[2 * i + 1] = __builtin_shufflevector(b[i], b[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
  }
}

void to_lanes(const std::int16_t* const* from, int count, std::int16_t* out) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; lane += kBlock) {
    for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
      Block16 rows[kBlock];
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load<Block16>(from[lane + k] + i);
      transpose(rows);
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) store(rows[k], out + (i + k) * kLanes + lane);
    }
  }
}

void from_lanes(const std::int16_t* from, int count, std::uint8_t* const* out) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; lane += kBlock) {
    for (std::ptrdiff_t i = 0; i < count; i += kBlock) {
      Block16 rows[kBlock];
      for (std::ptrdiff_t k = 0; k < kBlock; ++k) rows[k] = load<Block16>(from + (i + k) * kLanes + lane);
      transpose(rows);
      for (std::ptrdiff_t k = 0; k < kBlock; ++k)
        store(__builtin_convertvector(rows[k], Block8), out[lane + k] + i);
    }
  }
}

// Window sums of up to 14 bits, so that 16 hold a key: the sum above the last two bits of the disparity,
// counted from the smallest value on. The group of 4 disparities is kept beside the best key.
struct NarrowKeys {
  static constexpr int kGroup = 4;
  static constexpr int kScale = 4;
  using Key = Halves;
  struct Best {
    Halves key;
    Halves group;
  };

  static Key without_sum(int disparity) { return halves(-32768 + disparity % kGroup); }
  static void add(Key& key, Halves column_sum) { key += column_sum; }
  static Key least(Key a, Key b) { return smaller(a, b); }
  static Key most(Key key, Halves floor) { return larger(key, floor); }
  static Key none() { return halves(32767); }
  static Best best_of_none() { return {none(), Halves{}}; }
  // Sums decide: of equal ones the disparity that was there first, which is the smaller one.
  static Best better(const Best& best, const Best& other) {
    const auto smaller_sum = (best.key & -kGroup) > other.key;
    return {smaller_sum ? other.key : best.key, smaller_sum ? other.group : best.group};
  }
  static Best better(const Best& best, Key key, int group) { return better(best, {key, halves(group)}); }
  // Each lane gets that of the lane before it.
  static Best load_moved(const Best* best, Halves floor) {
    const auto* lanes = reinterpret_cast<const std::int16_t*>(best);
    return {larger(load<Halves>(lanes - 1), floor), load<Halves>(lanes + kLanes - 1)};
  }
  static Halves disparity(const Best& best) { return best.group + (best.key & (kGroup - 1)); }
};

// 32 bits hold any sum and all of the disparity.
struct WideKeys {
  static constexpr int kGroup = 2;
  static constexpr int kScale = 1;
  struct Key {
    Words even;
    Words odd;
  };
  using Best = Key;

  static Key without_sum(int disparity) { return {words(disparity), words(disparity)}; }
  static void add(Key& key, Halves column_sum) {
    key.even += even_lanes(column_sum) << 8;
    key.odd += odd_lanes(column_sum) << 8;
  }
  static Key least(const Key& a, const Key& b) { return {smaller(a.even, b.even), smaller(a.odd, b.odd)}; }
  static Key most(const Key& key, Halves floor) {
    return {larger(key.even, even_lanes(floor) << 16), larger(key.odd, odd_lanes(floor) << 16)};
  }
  static Key none() { return {words(0x7FFF0000), words(0x7FFF0000)}; }
  static Best best_of_none() { return none(); }
  static Best better(const Best& best, const Best& other) { return least(best, other); }
  static Best better(const Best& best, const Key& key, int /*group*/) { return least(best, key); }
  static Best load_moved(const Best* best, Halves floor) {
    const auto* lanes = reinterpret_cast<const std::int32_t*>(best);
    return most({load<Words>(lanes + kLanes / 2 - 1), best->even}, floor);
  }
  static Halves disparity(const Best& best) { return join_lanes(best.even & 0xFF, best.odd & 0xFF); }
};

// Column sums of kCount neighbouring disparities, which lie side by side, at one position after the other.
// Pointers and not indices, in an object that nothing else points to: a store could change what is read
// through others.
template <int kScale, int kCount>
struct ColumnSums {
  const std::int16_t* right;
  const std::int16_t* left;
  std::int16_t* sums;

  // Adds the change at this position to the sum of the j-th disparity and returns it.
  Halves add(Halves right_pixels, std::ptrdiff_t j) const {
    std::int16_t* place = sums + j * kLanes;
    const Halves sum = load<Halves>(place) + change<kScale>(right_pixels, load<Halves>(left + j * kLanes));
    store(sum, place);
    return sum;
  }
  void next() {
    right += kLanes;
    left += kLanes;
    sums += kCount * kLanes;
  }
};

// One group of disparities on its way along the row.
template <class Keys, int kCount>
struct Group {
  using Key = typename Keys::Key;
  using Best = typename Keys::Best;

  ColumnSums<Keys::kScale, kCount> columns;
  const std::int16_t* outside;
  Best* right_best;
  Best* left_best;
  std::ptrdiff_t window_begin;  // from the sums that enter the window to those that leave it
  int first;                    // disparity
  Key keys[kCount];
  Key passing[kCount];  // the best for left windows that the group's other disparities have yet to reach

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
      const auto right = load<Halves>(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) Keys::add(keys[j], columns.add(right, j));
      columns.next();
    }
  }

  template <bool kRightBased, bool kSomeOutside>
  void match(int count) {
    for (std::ptrdiff_t s = 0; s < count; ++s) {
      const auto right = load<Halves>(columns.right);
      for (std::ptrdiff_t j = 0; j < kCount; ++j) {
        const auto leaving = load<Halves>(columns.sums + window_begin + j * kLanes);
        Keys::add(keys[j], columns.add(right, j) - leaving);
      }
      columns.next();
      if (kRightBased) {
        auto least = keys[0];
        for (std::ptrdiff_t j = 0; j < kCount; ++j) {
          auto key = keys[j];
          if (kSomeOutside) key = Keys::most(key, load<Halves>(outside + j * kLanes));
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
    const auto right = load<Halves>(columns.right);
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
  // In place: `out` is where the keys begin, and they are longer.
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
  // Left windows beyond the end of a segment belong to the next one, where their disparities are smaller.
  const auto band_begins = load<Halves>(memory.band_begins);
  for (std::ptrdiff_t p = left_positions - 1; p >= plan.columns; --p) {
    auto& own = left[p - plan.columns];
    own = Keys::better(own, Keys::load_moved(left + p, band_begins));
  }
  store_disparities<Keys>(left, plan.columns, memory.left_best);
  if (plan.right_based) store_disparities<Keys>(right, plan.columns, memory.right_best);
}

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

}  // namespace

extern const ImageLoops STEREOTLM_IMAGE_LOOPS;
const ImageLoops STEREOTLM_IMAGE_LOOPS = {STEREOTLM_INSTRUCTION_SET,
                                          int{kLanes},
                                          rectify,
                                          add_rows,
                                          filter_row,
                                          pair_pixels,
                                          to_lanes,
                                          from_lanes,
                                          add_row,
                                          match_row};

}  // namespace stereotlm::kernels
