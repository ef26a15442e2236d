#include "calib/tables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

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

// Rows of the source picture, both ends included; none if last < first.
struct SourceRows {
  int first = std::numeric_limits<int>::max();
  int last = -1;

  void include(const SourceRows& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
  int count() const { return last < first ? 0 : last - first + 1; }
};

// The source rows of each row of the rectified picture.
std::vector<SourceRows> rows_of(const kernels::RectificationTable& table) {
  std::vector<SourceRows> rows(static_cast<std::size_t>(table.height));
  auto entry = table.entries.begin();
  for (SourceRows& row : rows) {
    for (const auto end = entry + table.width; entry != end; ++entry) {
      if (kernels::entry_is_valid(*entry)) {
        row.include({kernels::entry_row(*entry), kernels::entry_row(*entry)});
      }
    }
  }
  return rows;
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
  const auto width = static_cast<std::size_t>(rig.width);
  std::size_t different = 0;
  for (std::size_t i = 0; i < tables.left.entries.size(); i += kStep) {
    const auto column = static_cast<double>(i % width);
    const std::size_t row_number = i / width;
    const auto row = static_cast<double>(row_number);
    if (tables.left.entries[i] != table_entry(rig, left, {column + disparity_offset, row})) ++different;
    if (tables.right.entries[i] != table_entry(rig, right, {column, row})) ++different;
  }
  // One compared entry in 1000 may differ: another machine may round a position half way between two pixels
  // differently.
  return different <= tables.left.entries.size() / kStep / 1000;
}

std::string lut_bytes(const kernels::RectificationTable& table) {
  std::string bytes;
  bytes.reserve(4 * table.entries.size());
  for (const std::uint32_t entry : table.entries) {
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<char>(entry >> shift & 0xFFU));
  }
  return bytes;
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
  kernels::RectificationTable table{width, height, {}};
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::uint32_t entry = 0;
    for (std::size_t byte = 4; byte-- > 0;) entry = entry << 8U | static_cast<std::uint8_t>(bytes[at + byte]);
    table.entries.push_back(entry);
  }
  if (const auto found = kernels::problems(table); !found.empty()) throw std::runtime_error(found.front());
  return table;
}

std::vector<int> source_lines(const kernels::RectificationTable& table, int lines) {
  if (const auto found = problems(table); !found.empty()) throw std::invalid_argument(found.front());
  if (lines < 1 || lines > table.height) {
    throw std::invalid_argument("lines = " + std::to_string(lines) + ": must be 1.." +
                                std::to_string(table.height) + ", the height of the table");
  }
  const std::vector<SourceRows> rows = rows_of(table);
  std::vector<int> counts;
  for (auto top = rows.begin(); top + lines <= rows.end(); ++top) {
    SourceRows strip;
    std::for_each(top, top + lines, [&strip](const SourceRows& row) { strip.include(row); });
    counts.push_back(strip.count());
  }
  return counts;
}

}  // namespace stereotlm::calib
