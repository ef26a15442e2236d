#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stereotlm::kernels {

// Arrays with one value per disparity are padded to a multiple of this many values. The loops over a column
// read and write the padding.
inline constexpr int kLanePadding = 16;
constexpr int padded_lanes(int disparities) {
  return (disparities + kLanePadding - 1) / kLanePadding * kLanePadding;
}

// Simd::filter_column works on blocks of this many rows.
inline constexpr int kFilterBlock = 8;
constexpr int padded_rows(int rows) { return (rows + kFilterBlock - 1) / kFilterBlock * kFilterBlock; }

// Length of the longest vector of any instruction set, in lanes and in bytes. A lane has 16 bits. Positions,
// counts and offsets in this file are in lanes, unless their comment names another unit.
inline constexpr int kMostFrameLanes = 32;
inline constexpr int kMostFrameVectorBytes = 2 * kMostFrameLanes;

// Simd::filter_row works on blocks of this many vectors of pixels.
inline constexpr int kFilterVectors = 4;
inline constexpr int kFilterPadding = kFilterVectors * kMostFrameLanes;

// Two weights of a filter. The pixels of each weight are added up before they are weighted.
struct WeightPair {
  std::int32_t weights = 0;  // the first in the lower 16 bits, the second in the upper 16 bits
  int first_count = 0;       // number of pixels with the first weight
  int second_count = 0;      // number of pixels with the second weight
};
// The weights of a filter, and the pixels of a row that they weight.
struct FilterTaps {
  const WeightPair* pairs = nullptr;
  int pair_count = 0;
  // The pixels of the first weight of the first pair, then those of its second weight, and so on. Each points
  // to the pixel for output column 0; the pixels for the further columns follow it.
  const std::int16_t* const* pixels = nullptr;
  int shift = 0;
};

// How ImageMatcher divides an image among the lanes of a vector. The image is cut into bands of rows, and
// each band into segments of columns; each lane matches one segment of one band. Position p of a lane lies p
// columns right of the first column of its segment.
struct MatchPlan {
  int window = 0;
  int disparities = 0;
  bool right_based = true;  // whether right-based disparities are wanted
  int columns = 0;          // positions of a segment, one right window each; a multiple of 8
  // The first position at which the left window of the last segment is outside the image.
  int first_outside = 0;
};

// The arrays of one side, aligned to kMostFrameVectorBytes. Brackets give the positions of an array: pixels
// or windows, with one vector each unless the comment gives more. With the names of MatchPlan: the right side
// has `columns` windows, the left `columns + disparities - 1`; each side has `window - 1` more pixels.
struct MatchSide {
  // [pixels]: the lower byte of a lane enters the window, the upper byte leaves it. Pixels of more than one
  // byte have a plane for each byte; the planes are `stride` apart.
  const std::int16_t* pixels = nullptr;
  int stride = 0;
  // [windows]: while match_row() runs, the best key of each position so far, in MatchLoops::best_vectors
  // vectors. After it, in the same place: the disparities of positions 0 .. columns - 1, one vector each.
  std::int16_t* best = nullptr;
  // [pixels], with MatchLoops::unpacks: the pixels as numbers of 16 bits, in two vectors.
  std::int16_t* unpacked = nullptr;
};
struct MatchMemory {
  MatchSide right;
  MatchSide left;
  // [columns + disparities]: the largest 16-bit value if the left window is outside the image, else the
  // smallest.
  const std::int16_t* outside = nullptr;
  // [1]: the largest 16-bit value in the first lane of each band, else the smallest.
  const std::int16_t* band_begins = nullptr;
  // [disparities * (columns + window)], with MatchLoops::sum_vectors vectors per position; all 0 before the
  // first row.
  std::int16_t* column_sums = nullptr;
};

// The loops of one cost, and the memory that they need.
struct MatchLoops {
  int sum_vectors;   // vectors per position of MatchMemory::column_sums
  int best_vectors;  // vectors per position of MatchSide::best
  bool unpacks;      // uses MatchSide::unpacked
  // Moves all column sums one row down. To be called for the rows before the first windows are complete.
  void (*add_row)(const MatchPlan& plan, const MatchMemory& memory);
  // Moves one row down and stores the disparities of the row of windows in MatchSide::best, one per lane and
  // position.
  void (*match_row)(const MatchPlan& plan, const MatchMemory& memory);
};

// The candidates of a window: windows of the other side, for the disparities 0..count-1. The arrays may
// be read up to the next multiple of kLanePadding.
struct Candidates {
  int count;
  const double* sums;  // of the pixels of each candidate
  const std::int64_t* variances;
  const double* inverses;  // 1 / variance
};

// The inner loops of the kernels, built once per instruction set. The results are exact, and the same with
// each instruction set.
struct Simd {
  const char* name;

  // The loops over whole images.
  int lanes;  // lanes of a vector

  // out[i] = source pixel of table[i], 0 where the entry is not valid.
  void (*rectify)(const std::uint8_t* source, const std::uint32_t* table, int count, int width,
                  std::uint8_t* out);

  // out[u] = pixels[u], for `width` pixels.
  void (*widen)(const std::uint8_t* pixels, int width, std::int16_t* out);
  // out[u] = a[u] + b[u], for `width` values. The arrays hold whole vectors.
  void (*add_rows)(const std::int16_t* a, const std::int16_t* b, int width, std::int16_t* out);
  // out[u] = clamp(128 + floor(S / 2^shift), 0, 255), where S = sum over the taps of weight * pixel. Exact if
  // S fits into 32 bits, and the sum of the pixels of each weight into 16 bits. Reads the pixels and writes
  // `out` up to kFilterPadding pixels beyond `width`.
  void (*filter_row)(const FilterTaps& taps, int width, std::uint8_t* out);

  // out[i] = entering[i] + 256 * leaving[i].
  void (*pair_pixels)(const std::uint8_t* entering, const std::uint8_t* leaving, int width,
                      std::int16_t* out);
  // Stores `count` vectors: lane l of vector i is from[l][i]. Reads and writes up to the next multiple of 8.
  void (*to_lanes)(const std::int16_t* const* from, int count, std::int16_t* out);
  // The reverse of to_lanes(), with bytes as output.
  void (*from_lanes)(const std::int16_t* from, int count, std::uint8_t* const* out);
  // Checks `count` pixels of a row (contract 1.4): left_based[i] against right_based[i - left_based[i]], and
  // the valid bit of left_table[i]. out[i] = left_based[i], or kInvalidDisparity if a check fails. A null
  // `right_based` or `left_table` leaves out its check. left_based must hold valid disparities only, because
  // right_based is read for each of them.
  void (*check_row)(const std::uint8_t* left_based, const std::uint8_t* right_based,
                    const std::uint32_t* left_table, int count, int tolerance, std::uint8_t* out);
  // The census bits of one row (contract 7.6). `rows`: 2 * half + 1 rows, each from `half` columns left of
  // the first pixel on, with the upper bits inverted. out[b] gets bits 8b .. 8b + 7 of each pixel; the order
  // of the neighbours is the same for all. Reads the rows and writes `out` up to 64 pixels beyond `width`.
  void (*census_row)(const std::int8_t* const* rows, int half, int width, std::uint8_t* const* out);

  // The loops of each cost for windows of `window` x `window` pixels. `zncc` has none: CorrelationMatcher.
  MatchLoops (*sad_loops)(int window);
  MatchLoops (*ssd_loops)(int window);
  MatchLoops (*census_loops)(int bytes, int window);  // `bytes` of a pixel: 1, 3 or 6

  // The loops over one column of the matcher. Arrays over the disparities d hold `lanes` values, a multiple
  // of kLanePadding; arrays with values of more than 8 bits must be SimdArrays.
  //
  // Steps all column and window modules by one column. For each d: sum = the sum over the `rows` of
  // |histories[row][d] - left[row]|; windows[d] += sum - leaving[d]; leaving[d] = sum.
  void (*sad_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                      std::int16_t* leaving, std::int32_t* windows);
  // The same with the number of bits in which histories[row][d] and left[row] differ.
  void (*census_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                         std::int16_t* leaving, std::int32_t* windows);
  // The same with the square of the difference, and with the product.
  void (*ssd_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                      std::int32_t* leaving, std::int32_t* windows);
  void (*product_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                          std::int32_t* leaving, std::int32_t* windows);

  // Steps select-min unit A by one column: next[d] = min(held[d - 1], key(d)), where key(d) = sums[d] * 256 +
  // d for d < candidates, else INT32_MAX. Reads held[-1]; writes `next` from 0 on.
  void (*step_chain)(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                     std::int32_t* next);

  // Select-min unit B: returns the smallest key(d).
  std::int32_t (*smallest_key)(const std::int32_t* sums, int candidates, int lanes);

  // Filters `rows` pixels of one column with a size x size kernel (size odd): out[k] = clamp(128 + floor(S /
  // 2^shift), 0, 255), where S = sum over i, j of weights[i * size + j] * (value k + j of column i), and
  // column i starts at columns + i * stride. Exact while no partial sum leaves -2^24..2^24. Reads columns up
  // to padded_rows(rows) + size - 1, and writes `out` up to padded_rows(rows).
  void (*filter_column)(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                        int shift, std::uint8_t* out);

  // The loops of CorrelationMatcher.
  //
  // Adds the sum over the 2 * `pairs` rows of own[row] * rows[row][d] to column[d], then column[d] -
  // leaving[d] to window[d], for `lanes` disparities d, a multiple of kLanePadding.
  void (*add_products)(const std::uint8_t* const* rows, const std::int16_t* own, int pairs, int lanes,
                       std::int32_t* column, const std::int32_t* leaving, std::int32_t* window);

  // Returns the first candidate with the greatest score, for a window of `pixels` pixels with the sum
  // `own_sum`. products[d]: the sum of its pixels times the pixels of candidate d. All arrays have the
  // padding of the arrays of `candidates`. `quotients` is memory for intermediate values.
  int (*best_candidate)(const Candidates& candidates, const std::int32_t* products, double pixels,
                        double own_sum, double* quotients);
};

// Returns the instruction sets of this machine from `best` on, in the order avx512, avx2, base; all of them
// if `best` is null. Throws std::invalid_argument if the machine does not have `best`.
std::vector<const Simd*> simd_sets_from(const char* best);
// The instruction sets that the kernels may use, best first. For measurements the environment variable
// STEREOTLM_VECTORS names the first one.
const std::vector<const Simd*>& simd_sets();
inline const Simd& best_simd() { return *simd_sets().front(); }

// An array of at least `size` values, at first zeros, in whole vectors of any instruction set.
template <class Value>
class SimdArray {
 public:
  SimdArray() = default;
  template <class Size>
  explicit SimdArray(Size size) : blocks_((static_cast<std::size_t>(size) + kBlock - 1) / kBlock) {}
  // Null if the array is empty.
  Value* data() { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  const Value* data() const { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  void fill(Value value) {
    for (Block& block : blocks_) std::fill(block.begin(), block.end(), value);
  }
  void swap(SimdArray& other) { blocks_.swap(other.blocks_); }

 private:
  static constexpr std::size_t kBlock = kMostFrameVectorBytes / sizeof(Value);
  struct alignas(kMostFrameVectorBytes) Block : std::array<Value, kBlock> {};
  std::vector<Block> blocks_;
};
using VectorArray = SimdArray<std::int16_t>;

}  // namespace stereotlm::kernels
