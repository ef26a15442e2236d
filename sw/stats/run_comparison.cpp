#include "sw/stats/run_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/fpga/core_ports.h"

namespace stereotlm::stats {
namespace {

std::int64_t difference(std::uint64_t a, std::uint64_t b) { return static_cast<std::int64_t>(b - a); }

bool is_empty(const RowComparison::Range& range) {
  return range.least == 0 && range.most == 0 &&
         std::all_of(range.stalls.begin(), range.stalls.end(), [](std::int64_t sum) { return sum == 0; });
}

std::string csv_head() {
  std::string text = "frame,row,a_cycles,b_cycles";
  for (const char* run : {"a", "b"}) {
    for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group)
      text += fmt::format(",{}_{}_stall_cycles", run, fpga::kPortGroups[group].name);
  }
  return text + '\n';
}

// The stalls of ports, added for each port group: two runs may have different numbers of lanes.
std::array<std::uint64_t, fpga::kCoreGroupCount> by_group(const std::vector<std::uint64_t>& stalls) {
  const auto ports = fpga::CorePorts::of_core_size(stalls.size());
  std::array<std::uint64_t, fpga::kCoreGroupCount> sums{};
  for (memory::Port port = 0; port < stalls.size(); ++port) sums[ports.group_of(port)] += stalls[port];
  return sums;
}

}  // namespace

void PixelComparison::add(std::uint64_t camera_frame, const kernels::GrayImage& a,
                          const kernels::GrayImage& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::invalid_argument("disparities of different sizes have no pixels in common");
  const std::uint64_t before = pixels_;
  for (int row = 0; row < a.height; ++row) {
    for (int column = 0; column < a.width; ++column) {
      const int of_a = a.at(column, row);
      const int of_b = b.at(column, row);
      if (of_a == of_b) continue;
      if (!first_) first_ = First{camera_frame, column, row, of_a, of_b};
      ++pixels_;
    }
  }
  ++frames_;
  if (pixels_ != before) ++frames_that_differ_;
}

fpga::RowProfile rows_alone(const fpga::RowProfile& profile) {
  fpga::RowProfile rows = profile;
  for (std::size_t row = rows.size(); row-- > 1;) {
    rows[row].cycles -= profile[row - 1].cycles;
    for (std::size_t port = 0; port < rows[row].stalls.size(); ++port)
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
    const auto stalls_a = by_group(alone_a[row].stalls);
    const auto stalls_b = by_group(alone_b[row].stalls);
    if (!other_stalls_ && stalls_a != stalls_b) other_stalls_ = OtherStalls{frames_, row};
    rows_[row].cycles += difference(alone_a[row].cycles, alone_b[row].cycles);
    for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group)
      rows_[row].stalls[group] += difference(stalls_a[group], stalls_b[group]);
  }
  ++frames_;
}

RowComparison::Range RowComparison::range(std::size_t first_row, std::size_t last_row) const {
  Range range{first_row, last_row, 0, rows_[first_row].cycles, rows_[first_row].cycles, {}};
  for (std::size_t row = first_row; row <= last_row; ++row) {
    range.cycles += rows_[row].cycles;
    range.least = std::min(range.least, rows_[row].cycles);
    range.most = std::max(range.most, rows_[row].cycles);
    for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group)
      range.stalls[group] += rows_[row].stalls[group];
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

RowsCsv::RowsCsv(const std::filesystem::path& path)
    : file_(path, files::marked_kind("table of stereotlm diff", {{0, csv_head()}})) {
  file_.write(csv_head());
}

void RowsCsv::add(const fpga::RowProfile& a, const fpga::RowProfile& b) {
  const fpga::RowProfile alone_a = rows_alone(a);
  const fpga::RowProfile alone_b = rows_alone(b);
  std::string lines;
  for (std::size_t row = 0; row < a.size(); ++row) {
    lines += fmt::format("{},{},{},{},{},{}\n", frame_, row, alone_a[row].cycles, alone_b[row].cycles,
                         fmt::join(by_group(alone_a[row].stalls), ","),
                         fmt::join(by_group(alone_b[row].stalls), ","));
  }
  ++frame_;
  file_.write(lines);
}

}  // namespace stereotlm::stats
