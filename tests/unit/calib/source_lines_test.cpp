#include "calib/source_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

namespace stereotlm::calib {
namespace {

using kernels::make_entry;
using kernels::RectificationTable;

// The definition of the header, entry by entry.
std::vector<int> expected_lines(const RectificationTable& table, int lines) {
  std::vector<int> expected;
  for (int top = 0; top + lines <= table.height; ++top) {
    std::vector<int> named;
    for (int i = top * table.width; i < (top + lines) * table.width; ++i) {
      const std::uint32_t entry = table.entries[static_cast<std::size_t>(i)];
      if (kernels::entry_is_valid(entry)) named.push_back(kernels::entry_row(entry));
    }
    const auto [first, last] = std::minmax_element(named.begin(), named.end());
    expected.push_back(named.empty() ? 0 : *last - *first + 1);
  }
  return expected;
}

TEST(SourceLines, FollowTheirDefinitionForAnyTable) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(0, 11);
  RectificationTable table{12, 12, {}};
  for (int i = 0; i < 144; ++i) {
    table.entries.push_back(place(random) < 10 ? 0 : make_entry(place(random), place(random)));
  }
  for (int lines = 1; lines <= 12; ++lines)
    EXPECT_EQ(source_lines(table, lines), expected_lines(table, lines));
}

TEST(SourceLines, RefuseAWindowOutsideThePictureOrABrokenTable) {
  RectificationTable table = kernels::identity_table(8, 6);
  EXPECT_THROW(source_lines(table, 0), std::invalid_argument);
  EXPECT_EQ(source_lines(table, 6), std::vector<int>(1, 6));
  EXPECT_THROW(source_lines(table, 7), std::invalid_argument);
  table.entries.pop_back();
  EXPECT_THROW(source_lines(table, 1), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
