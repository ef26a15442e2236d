#include "models/kernels/joint_table.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace stereotlm::kernels {
namespace {

// The least and the greatest of some displacements. Both are 0 if there is none.
struct Range {
  int least = 0;
  int greatest = 0;

  int size() const { return greatest - least + 1; }
  int middle() const {  // rounded down
    const int sum = least + greatest + 1;
    return (sum - (sum < 0 && sum % 2 != 0 ? 1 : 0)) / 2;
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
  bool is_first = true;
  const auto widen = [&is_first](Range& range, int value) {
    range.least = is_first ? value : std::min(range.least, value);
    range.greatest = is_first ? value : std::max(range.greatest, value);
  };
  for_each_entry(table, [&](std::uint32_t entry, int column, int row) {
    if (!entry_is_valid(entry)) return;
    widen(ranges.columns, entry_column(entry) - column);
    widen(ranges.rows, entry_row(entry) - row);
    is_first = false;
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

std::vector<std::string> problems_of(const Ranges& left, const Ranges& right) {
  std::vector<std::string> found;
  check("left", left, found);
  check("right", right, found);
  return found;
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
  return problems_of(ranges_of(left), ranges_of(right));
}

JointTable join_tables(const RectificationTable& left, const RectificationTable& right) {
  const Ranges of_left = ranges_of(left);
  const Ranges of_right = ranges_of(right);
  if (const auto found = problems_of(of_left, of_right); !found.empty())
    throw std::invalid_argument(found.front());
  JointTable joint{std::vector<std::uint32_t>(left.entries.size()),
                   {offset_of(of_left), offset_of(of_right)}};
  add_halves(left, joint.offsets[0], 16, joint.words);
  add_halves(right, joint.offsets[1], 0, joint.words);
  return joint;
}

}  // namespace stereotlm::kernels
