#include "models/kernels/rectification_table.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using Problems = std::vector<std::string>;

TEST(RectificationTable, IsTheIdentityWithoutCalibration) {
  const RectificationTable table = identity_table(8, 3);
  ASSERT_EQ(table.entries.size(), 24U);
  EXPECT_EQ(table.entries[0], 0x8000'0000U);
  EXPECT_EQ(table.entries[7], 0x8000'0007U);
  EXPECT_EQ(table.entries[8], 0x8001'0000U);
  EXPECT_EQ(table.entries[23], 0x8002'0007U);
  EXPECT_EQ(problems(table), Problems());
}

TEST(RectificationTable, HasRowColumnAndValidBitInTheirPlaces) {
  EXPECT_EQ(make_entry(0x7FF, 0x7FF), 0x87FF'07FFU);
  EXPECT_EQ(entry_column(0x8123'0456U), 0x456);
  EXPECT_EQ(entry_row(0x8123'0456U), 0x123);
  EXPECT_TRUE(entry_is_valid(0x8000'0000U));
  EXPECT_FALSE(entry_is_valid(0x7FFF'FFFFU));
}

TEST(RectificationTable, HasZerosInAllOtherBits) {
  for (int bit = 0; bit < 32; ++bit) {
    RectificationTable table = identity_table(4, 2);
    table.entries[6] = 1U << bit;  // not valid unless bit 31 is set, then pixel (0, 0)
    const bool other = (bit >= 11 && bit <= 15) || (bit >= 27 && bit <= 30);
    EXPECT_EQ(problems(table).size(), other ? 1U : 0U) << bit;
  }
  RectificationTable table = identity_table(4, 2);
  table.entries[6] = 0x8000'0800U;
  EXPECT_EQ(problems(table), Problems{"entry (2, 1) = 0x80000800: bits 30..27 and 15..11 must be 0"});
}

TEST(RectificationTable, PointsInsideTheImageWhereItIsValid) {
  RectificationTable table = identity_table(8, 3);
  table.entries[1] = make_entry(7, 2);
  table.entries[2] = make_entry(8, 3) & ~kEntryValid;
  EXPECT_EQ(problems(table), Problems());
  for (const auto& [entry, text] :
       {std::pair(make_entry(8, 2), "0x80020008"), std::pair(make_entry(7, 3), "0x80030007")}) {
    table.entries[1] = entry;
    EXPECT_EQ(problems(table), Problems{std::string("entry (1, 0) = ") + text +
                                        ": a valid source position must lie inside the 8 x 3 image"});
  }
}

TEST(RectificationTable, HasASizeOf1To2048AndAnEntryForEachPixel) {
  EXPECT_EQ(problems(identity_table(2048, 1)), Problems());
  EXPECT_EQ(problems(identity_table(1, 2048)), Problems());
  for (const auto& [width, height] :
       {std::pair(2049, 1), std::pair(1, 2049), std::pair(0, 5), std::pair(5, 0)}) {
    EXPECT_EQ(problems(identity_table(width, height)),
              Problems{"table size = " + std::to_string(width) + " x " + std::to_string(height) +
                       ": must be 1..2048 each"});
  }
  for (const std::size_t entries : {23U, 25U}) {
    EXPECT_EQ(problems({8, 3, std::vector<std::uint32_t>(entries)}),
              Problems{"table entries = " + std::to_string(entries) + ": must be width * height = 24"});
  }
}

TEST(RectificationTable, ReportsTheFirstTenProblems) {
  EXPECT_EQ(problems({4, 3, std::vector<std::uint32_t>(12, 0x800U)}).size(), 10U);
}

TEST(RectificationTable, RectifiesAsTheReferenceDoes) {
  int with_table = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const test::RandomBoard board = test::make_random_board(seed);
    if (!board.left_table) continue;
    ++with_table;
    const auto& pixels = board.pictures.front().left;
    EXPECT_EQ(rectify(test::gray_image(board, pixels), *test::table(board, board.left_table)).pixels,
              test::reference_rectify(board.width, board.height, pixels, board.left_table))
        << describe(board);
  }
  EXPECT_GT(with_table, 100);
}

TEST(RectificationTable, RefusesAnImageOfAnotherSizeAndABrokenTable) {
  RectificationTable table = identity_table(8, 3);
  EXPECT_NO_THROW(rectify(GrayImage(8, 3), table));
  EXPECT_THROW(rectify(GrayImage(8, 4), table), std::invalid_argument);
  EXPECT_THROW(rectify(GrayImage(4, 3), table), std::invalid_argument);
  table.entries[0] = make_entry(8, 0);
  EXPECT_THROW(rectify(GrayImage(8, 3), table), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
