#include "models/kernels/joint_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stereotlm::kernels {
namespace {

// The least and the greatest of some displacements.
struct Range {
  int least = std::numeric_limits<int>::max();
  int greatest = std::numeric_limits<int>::min();

  void widen(int value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  bool is_empty() const { return least > greatest; }
  int size() const { return is_empty() ? 1 : greatest - least + 1; }
  int middle() const {  // rounded down; 0 without any
    return is_empty() ? 0 : static_cast<int>(std::floor((least + greatest + 1) / 2.0));
  }
};

// The displacements of the valid entries of one side.
struct Ranges {
  Range columns;
  Range rows;
};

template <typename Visit>
void for_each_entry(const RectificationTable& table, const Visit& visit) {
  auto entry = table.entries.begin();
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) visit(*entry++, column, row);
  }
}

Ranges ranges_of(const RectificationTable& table) {
  Ranges ranges;
  for_each_entry(table, [&](std::uint32_t entry, int column, int row) {
    if (!entry_is_valid(entry)) return;
    ranges.columns.widen(entry_column(entry) - column);
    ranges.rows.widen(entry_row(entry) - row);
  });
  return ranges;
}

JointOffset offset_of(const Ranges& ranges) { return {ranges.columns.middle(), ranges.rows.middle()}; }

void check(const char* side, const Ranges& ranges, std::vector<std::string>& found) {
  const auto check_range = [&](const char* coordinate, const Range& range, int most) {
    if (range.size() <= most) return;
    found.push_back(std::string(side) + " table: its displacements in " + coordinate + " are " +
                    std::to_string(range.least) + ".." + std::to_string(range.greatest) + ", a range of " +
                    std::to_string(range.size()) + ": joint tables have " + std::to_string(most));
  };
  check_range("x", ranges.columns, kJointColumns);
  check_range("y", ranges.rows, kJointRows);
}

void add_halves(const RectificationTable& table, const JointOffset& offset, unsigned lowest_bit,
                std::vector<std::uint32_t>& words) {
  auto word = words.begin();
  for_each_entry(table, [&](std::uint32_t entry, int column, int row) {
    std::uint32_t& joined = *word++;
    if (!entry_is_valid(entry)) return;
    const int columns = entry_column(entry) - column - offset.columns + kJointColumns / 2;
    const int rows = entry_row(entry) - row - offset.rows + kJointRows / 2;
    joined |= (0x8000U | static_cast<std::uint32_t>(rows) << 8U | static_cast<std::uint32_t>(columns))
              << lowest_bit;
  });
}

}  // namespace

std::vector<std::string> joint_problems(const RectificationTable& left, const RectificationTable& right) {
  std::vector<std::string> found;
  check("left", ranges_of(left), found);
  check("right", ranges_of(right), found);
  return found;
}

JointTable join_tables(const RectificationTable& left, const RectificationTable& right) {
  if (const auto found = joint_problems(left, right); !found.empty())
    throw std::invalid_argument(found.front());
  JointTable joint{std::vector<std::uint32_t>(left.entries.size()),
                   {offset_of(ranges_of(left)), offset_of(ranges_of(right))}};
  add_halves(left, joint.offsets[0], 16, joint.words);
  add_halves(right, joint.offsets[1], 0, joint.words);
  return joint;
}

}  // namespace stereotlm::kernels
