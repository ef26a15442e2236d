#pragma once

#include <cstdint>

namespace stereotlm::kernels {

// Length of the longest vector of any instruction set, in lanes and in bytes. A lane has 16 bits. Positions,
// counts and offsets in this file are in lanes, unless their comment names another unit.
inline constexpr int kMostFrameLanes = 32;
inline constexpr int kMostFrameVectorBytes = 2 * kMostFrameLanes;

// Filter taps as pairs of neighbouring columns: weights[row * pairs + p] holds the weight of column 2p in the
// lower 16 bits and the weight of column 2p + 1 in the upper 16 bits. A weight that does not exist is 0.
struct FilterTaps {
  int rows = 0;
  int pairs = 0;
  int shift = 0;
  const std::int32_t* weights = nullptr;
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
  int right_stride = 0;  // of MatchMemory::right_pixels: from one plane to the next
  int left_stride = 0;   // of MatchMemory::left_pixels: from one plane to the next
};

// The arrays of the loops, aligned to kMostFrameVectorBytes. The comment of an array gives the number of its
// positions: [n]. Each position has one vector, unless the comment gives another number.
struct MatchMemory {
  // In each lane the byte that enters the window is the lower one, the byte that leaves the window the upper
  // one. Pixels of more than one byte have a plane for each byte. The planes are MatchPlan::right_stride and
  // MatchPlan::left_stride apart.
  const std::int16_t* right_pixels = nullptr;  // [columns + window - 1]
  const std::int16_t* left_pixels = nullptr;   // [columns + window + disparities - 2]
  // [columns + disparities]: the largest 16-bit value if the left window is outside the image, else the
  // smallest.
  const std::int16_t* outside = nullptr;
  // [1]: the largest 16-bit value in the first lane of each band, else the smallest.
  const std::int16_t* band_begins = nullptr;
  // [disparities * (columns + window)], with MatchLoops::sum_vectors vectors per position; all 0 before the
  // first row.
  std::int16_t* column_sums = nullptr;
  // While match_row() runs: the best key of each position so far, in MatchLoops::best_vectors vectors. When
  // it returns, in the same place: the disparities of positions 0 .. columns - 1, in one vector each.
  std::int16_t* right_best = nullptr;  // [columns]
  std::int16_t* left_best = nullptr;   // [columns + disparities - 1]

  // With MatchLoops::unpacks: the pixels as numbers of 16 bits, two vectors per position. Positions as in
  // right_pixels and left_pixels.
  std::int16_t* right_unpacked = nullptr;
  std::int16_t* left_unpacked = nullptr;
  // With MatchLoops::has_statistics: kColumnStatisticsVectors vectors per position; all 0 before the first
  // row. Positions as in right_pixels and left_pixels.
  std::int16_t* right_columns = nullptr;
  std::int16_t* left_columns = nullptr;
  // With MatchLoops::has_statistics: kWindowStatisticsVectors vectors per position.
  std::int16_t* right_windows = nullptr;  // [columns]
  std::int16_t* left_windows = nullptr;   // [columns + disparities - 1]
};
inline constexpr int kColumnStatisticsVectors = 4;
inline constexpr int kWindowStatisticsVectors = 6;

// Stored in place of a disparity that the vector arithmetic cannot decide. ImageMatcher then compares the
// candidates of the window exactly (CorrelationSearch).
inline constexpr int kUndecided = 255;

// The loops of one cost, and the memory that they need.
struct MatchLoops {
  int sum_vectors;      // vectors per position of MatchMemory::column_sums
  int best_vectors;     // vectors per position of MatchMemory::right_best and left_best
  bool unpacks;         // uses MatchMemory::right_unpacked and left_unpacked
  bool has_statistics;  // uses the statistics of columns and windows
  // Moves all column sums one row down. To be called for the rows before the first windows are complete.
  void (*add_row)(const MatchPlan& plan, const MatchMemory& memory);
  // Moves one row down and stores the disparities of the row of windows in right_best and left_best, one per
  // lane and position.
  void (*match_row)(const MatchPlan& plan, const MatchMemory& memory);
};

// The loops over whole images, for one instruction set.
struct FrameSimd {
  int lanes;  // lanes of a vector

  // out[i] = source pixel of table[i], 0 where the entry is not valid.
  void (*rectify)(const std::uint8_t* source, const std::uint32_t* table, int count, int width,
                  std::uint8_t* out);

  // out[u] = sum over the rows of rows[..][u], for `width` pixels.
  void (*add_rows)(const std::uint8_t* const* rows, int count, int width, std::int16_t* out);
  // out[u] = clamp(128 + floor(S / 2^shift), 0, 255), where S = sum over the taps of weight * rows[row][u +
  // column]. Exact if S fits into 32 bits. Reads the rows and writes `out` up to 64 pixels beyond `width`.
  void (*filter_row)(const std::int16_t* const* rows, const FilterTaps& taps, int width, std::uint8_t* out);

  // out[i] = entering[i] + 256 * leaving[i].
  void (*pair_pixels)(const std::uint8_t* entering, const std::uint8_t* leaving, int width,
                      std::int16_t* out);
  // Stores `count` vectors: lane l of vector i is from[l][i]. Reads and writes up to the next multiple of 8.
  void (*to_lanes)(const std::int16_t* const* from, int count, std::int16_t* out);
  // The reverse of to_lanes(), with bytes as output.
  void (*from_lanes)(const std::int16_t* from, int count, std::uint8_t* const* out);
  // The left-right check of `count` pixels of a row (contract 1.4), and the validity of their own entries:
  // out[i] = left_based[i], or kInvalidDisparity if it fails. right_based[i - left_based[i]] is read for each
  // pixel, so left_based must hold disparities only. A null `right_based` or `left_table` leaves out its
  // check.
  void (*check_row)(const std::uint8_t* left_based, const std::uint8_t* right_based,
                    const std::uint32_t* left_table, int count, int tolerance, std::uint8_t* out);
  // The census bits of one row (contract 7.6). `rows`: the 2 * half + 1 rows and columns around the first
  // pixel, with the upper bit of each pixel inverted. out[b] gets bits 8b .. 8b + 7 of each pixel; the order
  // of the neighbours is the same for all. Reads the rows and writes `out` up to 64 pixels beyond `width`.
  void (*census_row)(const std::int8_t* const* rows, int half, int width, std::uint8_t* const* out);

  // The loops of each cost for windows of `window` x `window` pixels. kUndecided comes from zncc_loops()
  // only.
  MatchLoops (*sad_loops)(int window);
  MatchLoops (*ssd_loops)(int window);
  MatchLoops (*zncc_loops)(int window);
  MatchLoops (*census_loops)(int bytes, int window);  // `bytes` of a pixel: 1, 3 or 6
};

}  // namespace stereotlm::kernels
