#include "models/kernels/joint_table.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"

namespace stereotlm::kernels {
namespace {

// Of 512 x 256 pixels; all other entries are not valid.
constexpr int kWidth = 512;
constexpr int kHeight = 256;

RectificationTable no_entries() {
  RectificationTable table{kWidth, kHeight, {}};
  table.entries.resize(std::size_t{kWidth} * kHeight);
  return table;
}

void set(RectificationTable& table, int column, int row, int columns, int rows) {
  table.entries[static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column)] =
      make_entry(column + columns, row + rows);
}

// A table that needs displacements of these ranges.
RectificationTable table_of(int least_columns, int most_columns, int least_rows, int most_rows) {
  RectificationTable table = no_entries();
  set(table, 200, 100, least_columns, least_rows);
  set(table, 201, 101, most_columns, most_rows);
  return table;
}

TEST(JointTable, FitsAnyRangeOf256ColumnsAnd128Rows) {
  for (const int shift : {-30, 0, 30}) {
    const RectificationTable fits = table_of(shift - 128, shift + 127, shift - 64, shift + 63);
    EXPECT_TRUE(joint_problems(fits, fits).empty());
    EXPECT_NO_THROW(join_tables(fits, fits));
  }
}

TEST(JointTable, IsRefusedWithTheSideTheCoordinateAndBothRanges) {
  const RectificationTable wide = table_of(-100, 156, 0, 0);
  const RectificationTable high = table_of(0, 0, -64, 64);
  EXPECT_EQ(joint_problems(wide, high),
            (std::vector<std::string>{
                "left table: its displacements in x are -100..156, a range of 257: joint tables have 256",
                "right table: its displacements in y are -64..64, a range of 129: joint tables have 128"}));
  EXPECT_EQ(joint_problems(high, wide).size(), 2U);
  EXPECT_THROW(join_tables(wide, no_entries()), std::invalid_argument);
  EXPECT_THROW(join_tables(no_entries(), high), std::invalid_argument);
}

TEST(JointTable, EqualsTheReferenceAndGivesTheEntriesBack) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const test::RandomBoard board = test::make_random_board(seed, test::RandomKnobs::all());
    if (!board.joint_tables) continue;
    const JointTable joint = join_tables({board.width, board.height, *board.left_table},
                                         {board.width, board.height, *board.right_table});
    const auto expected = test::reference_joint_table(board.width, *board.left_table, *board.right_table);
    ASSERT_EQ(joint.words, expected.words);
    ASSERT_EQ(joint.offsets,
              (JointOffsets{{{expected.left.x, expected.left.y}, {expected.right.x, expected.right.y}}}));
    for (std::size_t pixel = 0; pixel < joint.words.size(); ++pixel) {
      const int column = static_cast<int>(pixel) % board.width;
      const int row = static_cast<int>(pixel) / board.width;
      const auto valid = [pixel](const std::vector<std::uint32_t>& entries) {
        return entry_is_valid(entries[pixel]) ? entries[pixel] : 0;
      };
      ASSERT_EQ(left_entry(joint.words[pixel], column, row, joint.offsets), valid(*board.left_table));
      ASSERT_EQ(right_entry(joint.words[pixel], column, row, joint.offsets), valid(*board.right_table));
    }
  }
}

TEST(JointTable, KeepsElevenBitsOfASourceOutsideTheImage) {
  const JointOffsets offsets = {{{-1, INT32_MIN}, {INT32_MAX, 0}}};
  EXPECT_EQ(left_entry(0x8000'0000U | 64U << 24U | 128U << 16U, 0, 3, offsets), make_entry(0x7FF, 3));
  EXPECT_EQ(right_entry(0x8000U | 64U << 8U | 128U, 2, 0, offsets), make_entry(1, 0));
}

}  // namespace
}  // namespace stereotlm::kernels
