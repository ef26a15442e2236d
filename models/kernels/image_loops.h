#pragma once

#include <cstdint>
#include <vector>

// The inner loops of the kernels that work on whole images, one build of them per instruction set. The
// results are exact and the same with each.
namespace stereotlm::kernels {

// Vectors of 16-bit lanes; positions, counts and offsets below are in them where nothing else is said.
inline constexpr int kMostImageLanes = 32;
inline constexpr int kMostImageVectorBytes = 2 * kMostImageLanes;

// Filter taps as pairs of neighbouring columns: weights[row * pairs + p] holds that of column 2p in the lower
// and that of column 2p + 1 in the upper half; a weight that does not exist is 0.
struct FilterTaps {
  int rows = 0;
  int pairs = 0;
  int shift = 0;
  const std::int32_t* weights = nullptr;
};

// How an image is matched: each lane of a vector has its own segment of columns in its own band of rows.
// Position p of a lane lies p columns right of its segment's first one.
struct MatchPlan {
  int window = 0;
  int disparities = 0;
  bool right_based = true;  // whether the right-based match is wanted
  int columns = 0;          // positions of a segment: right windows of a lane; a multiple of 8
  int first_outside = 0;    // from this position on the left window of some lane is not in the image
};

// The largest window whose sums fit into 16 bits with two bits for the disparity behind them: 7 * 7 * 255 * 4
// does, 9 * 9 * 255 * 4 does not. (Without these bits all up to 15 * 15 * 255 do.)
inline constexpr int kLastNarrowWindow = 7;

// Vectors, one per position, at multiples of kMostImageVectorBytes.
struct MatchMemory {
  // The pixel that enters the window in the lower byte, the one that leaves it in the upper.
  const std::int16_t* right_pixels = nullptr;  // [columns + window - 1]
  const std::int16_t* left_pixels = nullptr;   // [columns + window + disparities - 2]
  const std::int16_t* outside = nullptr;  // [columns + disparities]: largest value where the left window is
                                          // not in the image, else smallest
  const std::int16_t* band_begins =
      nullptr;                          // [1]: largest value in the first lane of each band, else smallest
  std::int16_t* column_sums = nullptr;  // [disparities * (columns + window)], zeros before the first row
  std::int16_t* right_best = nullptr;   // [2 * columns]
  std::int16_t* left_best = nullptr;    // [2 * (columns + disparities)]
};

struct ImageLoops {
  const char* name;
  int lanes;

  // out[i] = source pixel of table[i], 0 where the entry is not valid.
  void (*rectify)(const std::uint8_t* source, const std::uint32_t* table, int count, int width,
                  std::uint8_t* out);

  // out[u] = sum over the rows of rows[..][u], for `width` pixels.
  void (*add_rows)(const std::uint8_t* const* rows, int count, int width, std::int16_t* out);
  // out[u] = clamp(128 + floor(S / 2^shift), 0, 255), S the sum over the taps of weight * rows[row][u +
  // column]. Exact if S is within 32 bits. `out` is written, and the rows are read, up to 64 pixels beyond
  // `width`.
  void (*filter_row)(const std::int16_t* const* rows, const FilterTaps& taps, int width, std::uint8_t* out);

  // out[i] = entering[i] + 256 * leaving[i].
  void (*pair_pixels)(const std::uint8_t* entering, const std::uint8_t* leaving, int width,
                      std::int16_t* out);
  // Vector i holds from[lane][i] of each lane, for i < count; up to the next multiple of 8 is read and
  // written.
  void (*to_lanes)(const std::int16_t* const* from, int count, std::int16_t* out);
  // The reverse, in bytes.
  void (*from_lanes)(const std::int16_t* from, int count, std::uint8_t* const* out);
  // One row down with all column sums, while the first windows are not complete.
  void (*add_row)(const MatchPlan& plan, const MatchMemory& memory);
  // One row down, and the disparities of its windows: one per lane and position, in right_best and left_best.
  void (*match_row)(const MatchPlan& plan, const MatchMemory& memory);
};

// Those that this machine can run, the best first. The environment variable STEREOTLM_VECTORS leaves out what
// is better than the one that it names (avx512, avx2, base), for measurements; throws std::invalid_argument
// if there is none of this name.
const std::vector<const ImageLoops*>& image_loops();

}  // namespace stereotlm::kernels
