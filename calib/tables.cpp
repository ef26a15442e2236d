#include "calib/tables.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace stereotlm::calib {
namespace {

kernels::RectificationTable table(const Rig& rig, const SourcePixels& sources, int column_offset) {
  kernels::RectificationTable result{rig.width, rig.height, {}};
  for (int row = 0; row < rig.height; ++row) {
    for (int column = 0; column < rig.width; ++column) {
      result.entries.push_back(table_entry(rig, sources, {column + column_offset, row}));
    }
  }
  if (const auto found = kernels::problems(result); !found.empty()) {
    throw std::invalid_argument(found.front());
  }
  return result;
}

}  // namespace

std::uint32_t table_entry(const Rig& rig, const SourcePixels& sources, const Eigen::Vector2d& rectified) {
  const auto source = sources.at(rectified);
  if (!source) return 0;
  const double column = std::floor(source->x() + 0.5);
  const double row = std::floor(source->y() + 0.5);
  const bool is_inside = column >= 0 && column < rig.width && row >= 0 && row < rig.height;
  return is_inside ? kernels::make_entry(static_cast<int>(column), static_cast<int>(row)) : 0;
}

TablePair tables(const Rig& rig, const Rectification& rectification, int disparity_offset) {
  const SourcePixels left(rig.left, rectification.r1, rectification.p1);
  const SourcePixels right(rig.right, rectification.r2, rectification.p2);
  return {table(rig, left, disparity_offset), table(rig, right, 0)};
}

bool are_tables_of(const TablePair& tables, const Rig& rig, const Rectification& rectification,
                   int disparity_offset) {
  constexpr std::size_t kStep = 97;  // between the entries that are compared
  const SourcePixels left(rig.left, rectification.r1, rectification.p1);
  const SourcePixels right(rig.right, rectification.r2, rectification.p2);
  std::size_t different = 0;
  for (std::size_t i = 0; i < tables.left.entries.size(); i += kStep) {
    const auto [row, column] = std::div(static_cast<int>(i), rig.width);
    if (tables.left.entries[i] != table_entry(rig, left, {column + disparity_offset, row})) ++different;
    if (tables.right.entries[i] != table_entry(rig, right, {column, row})) ++different;
  }
  // One compared entry in 1000 may differ: another machine may round half a pixel differently.
  return different <= tables.left.entries.size() / kStep / 1000;
}

// Entries are little endian, as in memory.
std::string lut_bytes(const kernels::RectificationTable& table) {
  return {reinterpret_cast<const char*>(table.entries.data()), 4 * table.entries.size()};
}

std::size_t lut_byte_count(int width, int height) {
  return 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height) {
  const std::size_t expected = lut_byte_count(width, height);
  if (bytes.size() != expected) {
    throw std::runtime_error(std::to_string(bytes.size()) + " bytes: a table for " + std::to_string(width) +
                             "x" + std::to_string(height) + " pixels has " + std::to_string(expected));
  }
  kernels::RectificationTable table{width, height, std::vector<std::uint32_t>(bytes.size() / 4)};
  std::memcpy(table.entries.data(), bytes.data(), bytes.size());
  if (const auto found = kernels::problems(table); !found.empty()) throw std::runtime_error(found.front());
  return table;
}

std::size_t entries_without_source(const kernels::RectificationTable& table) {
  return static_cast<std::size_t>(std::count_if(table.entries.begin(), table.entries.end(),
                                                [](std::uint32_t e) { return !kernels::entry_is_valid(e); }));
}

bool is_mostly_empty(const kernels::RectificationTable& table) {
  return entries_without_source(table) * 2 > table.entries.size();
}

void check_sources(const TablePair& tables, int disparity_offset) {
  for (const auto& [side, table] : {std::pair("left", &tables.left), std::pair("right", &tables.right)}) {
    if (!is_mostly_empty(*table)) continue;
    throw std::invalid_argument(fmt::format(
        "refused: the {} table would be empty in {} of {} entries: with disparities from {} on, the "
        "cameras of this calibration see too little of the same",
        side, entries_without_source(*table), table->entries.size(), disparity_offset));
  }
}

int source_lines(const kernels::RectificationTable& table, int lines) {
  if (const auto found = problems(table); !found.empty()) throw std::invalid_argument(found.front());
  if (lines < 1 || lines > table.height) {
    throw std::invalid_argument("lines = " + std::to_string(lines) + ": must be 1.." +
                                std::to_string(table.height) + ", the height of the table");
  }
  std::vector<int> first(static_cast<std::size_t>(table.height), table.height);  // [row]: its source rows
  std::vector<int> last(first.size(), -1);
  auto entry = table.entries.begin();
  for (std::size_t row = 0; row < first.size(); ++row) {
    for (const auto end = entry + table.width; entry != end; ++entry) {
      if (!kernels::entry_is_valid(*entry)) continue;
      first[row] = std::min(first[row], kernels::entry_row(*entry));
      last[row] = std::max(last[row], kernels::entry_row(*entry));
    }
  }
  int most = 0;
  for (std::ptrdiff_t top = 0; top + lines <= table.height; ++top) {
    most = std::max(most, *std::max_element(last.begin() + top, last.begin() + top + lines) + 1 -
                              *std::min_element(first.begin() + top, first.begin() + top + lines));
  }
  return most;
}

}  // namespace stereotlm::calib
