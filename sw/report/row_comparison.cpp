#include "sw/report/row_comparison.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::report {
namespace {

std::int64_t difference(std::uint64_t a, std::uint64_t b) { return static_cast<std::int64_t>(b - a); }

bool is_empty(const RowComparison::Range& range) {
  return range.least == 0 && range.most == 0 &&
         std::all_of(range.stalls.begin(), range.stalls.end(), [](std::int64_t sum) { return sum == 0; });
}

}  // namespace

fpga::RowProfile rows_alone(const fpga::RowProfile& profile) {
  fpga::RowProfile rows = profile;
  for (std::size_t row = rows.size(); row-- > 1;) {
    rows[row].cycles -= profile[row - 1].cycles;
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      rows[row].stalls[port] -= profile[row - 1].stalls[port];
  }
  return rows;
}

void RowComparison::add(const fpga::RowProfile& a, const fpga::RowProfile& b) {
  if (frames_ == 0) rows_.resize(a.size());
  if (a.size() != rows_.size() || b.size() != rows_.size())
    throw std::invalid_argument("frames of different heights have no rows in common");
  const fpga::RowProfile alone_a = rows_alone(a);
  const fpga::RowProfile alone_b = rows_alone(b);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    if (!parting_ && a[row].cycles != b[row].cycles)
      parting_ = Parting{frames_, row, a[row].cycles, b[row].cycles};
    if (!other_stalls_ && alone_a[row].stalls != alone_b[row].stalls)
      other_stalls_ = OtherStalls{frames_, row};
    rows_[row].cycles += difference(alone_a[row].cycles, alone_b[row].cycles);
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      rows_[row].stalls[port] += difference(alone_a[row].stalls[port], alone_b[row].stalls[port]);
  }
  ++frames_;
}

RowComparison::Range RowComparison::range(std::size_t first_row, std::size_t last_row) const {
  Range range{first_row, last_row, 0, rows_[first_row].cycles, rows_[first_row].cycles, {}};
  for (std::size_t row = first_row; row <= last_row; ++row) {
    range.cycles += rows_[row].cycles;
    range.least = std::min(range.least, rows_[row].cycles);
    range.most = std::max(range.most, rows_[row].cycles);
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      range.stalls[port] += rows_[row].stalls[port];
  }
  return range;
}

template <typename IsSame>
std::vector<RowComparison::Range> RowComparison::runs_of(const IsSame& is_same) const {
  std::vector<Range> runs;
  for (std::size_t row = 0, first = 0; row < rows_.size(); ++row) {
    if (row + 1 < rows_.size() && is_same(rows_[row], rows_[row + 1])) continue;
    const Range run = range(first, row);
    if (!is_empty(run)) runs.push_back(run);
    first = row + 1;
  }
  return runs;
}

std::vector<RowComparison::Range> RowComparison::ranges(std::size_t most_ranges) const {
  std::vector<Range> ranges =
      runs_of([](const Row& a, const Row& b) { return a.cycles == b.cycles && a.stalls == b.stalls; });
  if (ranges.size() <= most_ranges) return ranges;
  ranges = runs_of([](const Row& a, const Row& b) { return a.cycles == b.cycles; });
  if (ranges.size() <= most_ranges) return ranges;
  ranges.clear();
  for (std::size_t band = 0; band < most_ranges; ++band) {
    const std::size_t first = band * rows_.size() / most_ranges;
    const std::size_t end = (band + 1) * rows_.size() / most_ranges;
    const Range added = range(first, end - 1);
    if (!is_empty(added)) ranges.push_back(added);
  }
  return ranges;
}

}  // namespace stereotlm::report
