#pragma once

#include <cstdint>

#include "models/area/parts.h"
#include "models/kernels/matching_cost.h"

// The resources of the cost functions (contract 7.6): what compares two pixels, the census bits of a pixel,
// and what compares two scores of zncc.
namespace stereotlm::area {

// What a column module does with two pixels.
struct PairArithmetic {
  Resources resources;    // of one pair a cycle
  std::int64_t most = 0;  // largest value of the result
  int pixel_bits = 0;     // bits of a pixel, as it goes to the modules
};

//   sad     the absolute difference
//   ssd     the difference and a multiplier that squares it
//   zncc    a multiplier
//   census  two LUTs count how many of two bits differ; a tree of adders sums the counts
PairArithmetic pair_arithmetic(const kernels::MatchingCost& cost);

// The census bits of one pixel a cycle, on one side. c is the size of the neighbourhood: c * c - 1
// comparators, and registers for the pixels that the next position needs too. Behind a line buffer the
// neighbourhood moves to the right. In columns it moves down. At the top of a column it takes the c - 1 rows
// above from the line memories, and those of the c - 1 columns before from registers: a selector a bit.
Resources census_bits(const kernels::MatchingCost& cost, bool moves_down);

// zncc: the widths that follow from the window, and the parts for one pixel or candidate. N is the number of
// pixels of a window.
class ZnccArithmetic {
 public:
  explicit ZnccArithmetic(int window);

  int sum_bits() const { return sum_bits_; }                 // of the sum of the pixels of a window
  int variance_bits() const { return variance_bits_; }       // of N * sum(F^2) - sum(F)^2; also of |cov|
  int score_bits() const { return 3 * variance_bits_ + 1; }  // cov * |cov|, and the variance below it

  // N * sum(F^2) - sum(F)^2, with its register; the lowest bit of a variance of 0 is set, so that a fraction
  // is never 0 / 0.
  Resources variance() const;
  // cov = N * sum(FrFl) - sum(Fr) * sum(Fl), then cov * |cov|, with its register.
  Resources score() const;
  // Compares two fractions: each numerator times the variance below the other. Selects one of them.
  Resources select() const;

 private:
  int count_bits_;  // of N
  int sum_bits_;
  int product_bits_;  // of a sum of squares or products
  int variance_bits_;
};

}  // namespace stereotlm::area
