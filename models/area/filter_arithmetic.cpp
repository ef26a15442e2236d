#include "models/area/filter_arithmetic.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

namespace stereotlm::area {
namespace {

using Row = std::vector<int>;

// Repeats the last row below the image, and makes 8 bits of the result (log_filter.v).
constexpr Resources kRest{18 + 21, 18 + 9 + 50};
constexpr int kLeastBits = 17;  // of a sum, as log_filter.v has them

std::vector<Row> rows_of(const kernels::FilterKernel& kernel) {
  std::vector<Row> rows;
  for (auto first = kernel.weights.begin(); first != kernel.weights.end(); first += kernel.size)
    rows.emplace_back(first, first + kernel.size);
  return rows;
}

bool is_power_of_two(int magnitude) { return (magnitude & (magnitude - 1)) == 0; }

// With its sign. The sum of the positive weights is as large as that of the negative ones.
int sum_bits(const kernels::FilterKernel& kernel) {
  std::int64_t positive = 0;
  for (const int weight : kernel.weights) positive += std::max(weight, 0);
  return std::max(kLeastBits, bits_of(kMostPixel * positive) + 1);
}

}  // namespace

FilterArithmetic filter_arithmetic(const kernels::FilterKernel& kernel) {
  const std::vector<Row> rows = rows_of(kernel);
  const bool in_pairs = std::all_of(rows.begin(), rows.end(), [](const Row& row) {
    return std::equal(row.begin(), row.end(), row.rbegin());
  });
  const auto size = static_cast<std::size_t>(kernel.size);
  const std::size_t pairs = in_pairs ? size / 2 : 0;
  const std::set<Row> made(rows.begin(), rows.end());
  std::set<std::pair<std::size_t, int>> products;  // tap and magnitude of the weight
  int additions = 0;
  for (const Row& row : made) {
    bool is_empty = true;
    for (std::size_t tap = size; tap-- > pairs;) {  // what is added to nothing is free
      if (row[tap] == 0) continue;
      if (!is_empty || row[tap] < 0) ++additions;
      is_empty = false;
      if (!is_power_of_two(std::abs(row[tap]))) products.emplace(tap, std::abs(row[tap]));
    }
  }

  const int bits = sum_bits(kernel);
  const int places = kernel.size - 1;
  FilterArithmetic filter;
  filter.chain_bits = places * bits + kernel.half();
  const Resources edges = places * selector(kPixelBits) + registers(kernel.size * kPixelBits);
  // Each adder takes its second number from the chain or from the line memory; those of the first h places
  // also from the place before, in row 0.
  const Resources chain =
      places * adder(bits) + kernel.half() * selector(bits) + registers(filter.chain_bits);
  filter.resources = kRest + edges + static_cast<int>(pairs) * adder(bits_of(2 * kMostPixel)) +
                     additions * adder(bits) + static_cast<int>(made.size()) * registers(bits) + chain;
  filter.resources.multipliers = static_cast<std::int64_t>(products.size());
  return filter;
}

}  // namespace stereotlm::area
