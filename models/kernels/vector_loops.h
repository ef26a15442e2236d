#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// The inner loops of the column kernels, for the best instruction set of the machine that runs them (Highway,
// run-time dispatch). The results are exact and the same on every machine.
namespace stereotlm::kernels {

// Arrays that hold one value per disparity are padded to a multiple of this, and may be read and written up
// to there.
inline constexpr int kLanePadding = 16;
// Bytes to which those arrays are aligned: the longest vector that the loops use.
inline constexpr int kLaneAlignment = 32;

constexpr int padded_lanes(int disparities) {
  return (disparities + kLanePadding - 1) / kLanePadding * kLanePadding;
}

// An aligned array with at least `lanes` values, zeros at first.
template <class Value>
class LaneArray {
 public:
  explicit LaneArray(int lanes) : blocks_(static_cast<std::size_t>(padded_lanes(lanes) / kLanePadding)) {}
  Value* data() { return blocks_.data()->data(); }
  const Value* data() const { return blocks_.data()->data(); }
  void fill(Value value) {
    for (Block& block : blocks_) std::fill(block.begin(), block.end(), value);
  }
  void swap(LaneArray& other) { blocks_.swap(other.blocks_); }

 private:
  struct alignas(kLaneAlignment) Block : std::array<Value, kLanePadding> {};
  std::vector<Block> blocks_;
};

// One column of all column and window modules. For each lane d: the sum over the `rows` of
// |histories[row][d] - left[row]| is added to windows[d], what stood in leaving[d] is subtracted and replaced
// by it.
void step_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                  std::int16_t* leaving, std::int32_t* windows);

// One column of unit A: next[d] = min(held[d - 1], key(d)), key(d) = sums[d] * 256 + d for d < candidates,
// else INT32_MAX. held[-1] is read, `next` is written from 0.
void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* next);

// Unit B: the smallest key(d), as above.
std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes);

// Columns are filtered in blocks of this many rows.
inline constexpr int kFilterBlock = 8;
constexpr int padded_rows(int rows) { return (rows + kFilterBlock - 1) / kFilterBlock * kFilterBlock; }

// Filters `rows` pixels of one column with a size x size kernel (size odd): out[k] = clamp(128 + floor(S /
// 2^shift), 0, 255), S = sum over i, j of weights[i * size + j] * column i [k + j], where column i starts at
// columns + i * stride. Exact as long as no partial sum leaves -2^24..2^24. Columns are read up to
// padded_rows(rows) + size - 1, and `out` is written up to padded_rows(rows).
void filter_column(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                   int shift, std::uint8_t* out);

}  // namespace stereotlm::kernels
