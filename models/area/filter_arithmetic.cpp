#include "models/area/filter_arithmetic.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <set>
#include <vector>

namespace stereotlm::area {
namespace {

using Row = std::vector<int>;

Row row_of(const kernels::FilterKernel& kernel, int row) {
  const auto first = kernel.weights.begin() + static_cast<std::ptrdiff_t>(row) * kernel.size;
  return {first, first + kernel.size};
}

bool is_zero(const Range& range) { return range.low == 0 && range.high == 0; }

Range weighted(std::int64_t weight, std::int64_t most) {
  return {std::min<std::int64_t>(0, weight * most), std::max<std::int64_t>(0, weight * most)};
}

Range sum(const Range& a, const Range& b) { return {a.low + b.low, a.high + b.high}; }

// `weight` must not be 0. It may be negative.
int trailing_zeros(int weight) {
  int zeros = 0;
  for (; weight % 2 == 0; weight /= 2) ++zeros;
  return zeros;
}

bool is_power_of_two(int weight) { return bits_of(std::abs(weight)) == trailing_zeros(weight) + 1; }

// A pair of pixels with equal weight, or a single pixel.
struct Term {
  int weight;
  std::int64_t most;  // largest value of the pixel, or of the sum of the pair
};

std::vector<Term> terms_of(const Row& row, bool in_pairs) {
  const std::size_t pairs = in_pairs ? row.size() / 2 : 0;
  std::vector<Term> terms;
  for (std::size_t i = 0; i < row.size() - pairs; ++i) {
    if (row[i] != 0) terms.push_back({row[i], i < pairs ? 2 * kMostPixel : kMostPixel});
  }
  return terms;
}

struct RowSum {
  Resources resources;
  Range range;
};

// Returns the adders and multipliers of a row. The terms are added one by one, outermost first. A multiple of
// 2^z does not change the z lowest bits of the other addend, which need no adder.
RowSum row_sum(const std::vector<Term>& terms) {
  RowSum result;
  int zeros = 0;  // lowest bits that are 0 in the sum so far
  for (const Term& term : terms) {
    const int its_zeros = trailing_zeros(term.weight);
    const bool is_first = is_zero(result.range);
    result.range = sum(result.range, weighted(term.weight, term.most));
    if (!is_power_of_two(term.weight)) result.resources += {0, 0, 0, 1};
    if (!is_first) result.resources += adder(bits_of(result.range) - std::max(zeros, its_zeros));
    zeros = is_first ? its_zeros : std::min(zeros, its_zeros);
  }
  return result;
}

// The resources that clamp a sum of this range to 8 bits. The 7 lowest bits are kept if all bits above them
// are equal: the first LUT compares 4 of the bits above, each further LUT 2 more. Else one LUT for each of
// the 8 bits replaces the value by 0 or 255.
Resources clamp(const Range& range, int shift) {
  const int bits = bits_of(Range{range.low >> shift, range.high >> shift});
  if (bits <= kPixelBits) return {};
  const int upper = bits - (kPixelBits - 1);
  return Resources{kPixelBits + 1 + (std::max(upper, 4) - 3) / 2};
}

}  // namespace

FilterArithmetic filter_arithmetic(const kernels::FilterKernel& kernel) {
  std::vector<Row> rows;
  rows.reserve(static_cast<std::size_t>(kernel.size));
  for (int row = 0; row < kernel.size; ++row) rows.push_back(row_of(kernel, row));
  const bool in_pairs = std::all_of(rows.begin(), rows.end(), [](const Row& row) {
    return std::equal(row.begin(), row.end(), row.rbegin());
  });

  FilterArithmetic filter;
  for (int column = 0; in_pairs && column < kernel.half(); ++column) {
    const bool is_used = std::any_of(rows.begin(), rows.end(), [column](const Row& row) {
      return row[static_cast<std::size_t>(column)] != 0;
    });
    if (is_used) filter.resources += adder(bits_of(2 * kMostPixel));
  }
  std::set<Row> made;
  Range chain;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const RowSum row = row_sum(terms_of(rows[place], in_pairs));
    if (made.insert(rows[place]).second) filter.resources += row.resources;
    const bool adds = !is_zero(chain) && !is_zero(row.range);
    chain = sum(chain, row.range);
    if (adds) filter.resources += adder(bits_of(chain));
    if (place + 1 < rows.size()) filter.chain_bits += bits_of(chain);
  }
  filter.resources += registers(filter.chain_bits) + clamp(chain, kernel.shift);
  return filter;
}

}  // namespace stereotlm::area
