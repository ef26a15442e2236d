#include "calib/tables.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

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

}  // namespace stereotlm::calib
