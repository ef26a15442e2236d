#pragma once

#include <cstdint>
#include <optional>
#include <vector>

// The arithmetic of contract sections 1 and 7 as literal nested loops, written from that page alone. It
// shares no code with the models, which tests compare with it. Each function is one sentence or formula of
// the page, without regard to speed. Nothing checks the input, which must keep the rules of the page.
namespace stereotlm::test {

// K of contract 1.2.
struct ReferenceKernel {
  int size = 0;              // m: odd
  std::vector<int> weights;  // m * m, rows from j = -h (top), in each i = -h (left) first; sum 0
  int shift = 0;
};

// The cost function of contract 7.6.
struct ReferenceCost {
  enum class Kind { kSad, kSsd, kZncc, kCensus };
  Kind kind = Kind::kSad;
  int census_size = 0;  // c: 3, 5 or 7; only with kCensus
};
inline int half_of(const ReferenceCost& cost) {  // rows and columns that it looks ahead
  return cost.kind == ReferenceCost::Kind::kCensus ? (cost.census_size - 1) / 2 : 0;
}

struct ReferenceInput {
  int width = 0;                    // W, a multiple of 4
  int height = 0;                   // H
  std::vector<std::uint8_t> left;   // source pixels, row-major, W * H
  std::vector<std::uint8_t> right;  // likewise
  // Table entries, row-major, W * H; nullopt: a side without table.
  std::optional<std::vector<std::uint32_t>> left_table;
  std::optional<std::vector<std::uint32_t>> right_table;
  std::optional<ReferenceKernel> filter;  // nullopt: none
  int window = 0;                         // n, odd
  int disparities = 0;                    // D
  std::optional<int> lr_tolerance;        // t; nullopt: off
  ReferenceCost cost;
};

// All images are row-major, W * H values.
struct ReferenceResult {
  std::vector<std::uint8_t> rectified_left;    // P of the left side
  std::vector<std::uint8_t> rectified_right;   // P of the right side
  std::vector<std::uint8_t> filtered_left;     // Fl
  std::vector<std::uint8_t> filtered_right;    // Fr
  std::vector<int> right_based;                // dR, -1 where invalid
  std::vector<int> left_based;                 // dL, -1 where invalid
  std::vector<std::uint8_t> disparity;         // the output, 255 where invalid
  std::vector<std::uint32_t> disparity_words;  // the output as it lies in its buffer, W * H / 4 words
};

ReferenceResult compute_reference(const ReferenceInput& input);

// Single stages. `width` and `height` as in ReferenceInput.

// Contract 1.1. `table` nullopt: P = source.
std::vector<std::uint8_t> reference_rectify(int width, int height, const std::vector<std::uint8_t>& source,
                                            const std::optional<std::vector<std::uint32_t>>& table);

// Contract 1.2. `filter` nullopt: F = P.
std::vector<std::uint8_t> reference_filter(int width, int height, const std::vector<std::uint8_t>& rectified,
                                           const std::optional<ReferenceKernel>& filter);

// B of contract 7.6 for each pixel, a bit for each of the neighbours.
std::vector<std::uint64_t> reference_census(int width, int height, const std::vector<std::uint8_t>& filtered,
                                            int census_size);

// Contract 7.3: one table for both sides, with the four registers.
struct ReferenceMiddle {
  int x = 0;  // X of a side
  int y = 0;  // Y
};
struct ReferenceJointTable {
  std::vector<std::uint32_t> words;  // row-major, W * H
  ReferenceMiddle left;
  ReferenceMiddle right;
};
// From the entries of two separate tables, which must fit.
ReferenceJointTable reference_joint_table(int width, const std::vector<std::uint32_t>& left,
                                          const std::vector<std::uint32_t>& right);
// The entries of one side of a joint table, in the format of a separate table: 0 where an entry is not valid.
std::vector<std::uint32_t> reference_left_entries(int width, const ReferenceJointTable& table);
std::vector<std::uint32_t> reference_right_entries(int width, const ReferenceJointTable& table);

// Contract 1.5: four pixels to a word, lowest column in the lowest byte; `pixels` has a multiple of 4.
std::vector<std::uint32_t> reference_words(const std::vector<std::uint8_t>& pixels);

}  // namespace stereotlm::test
