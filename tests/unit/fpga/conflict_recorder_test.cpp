#include "models/fpga/record/conflict_recorder.h"

#include <gtest/gtest.h>

// The random boards and computers compare what the recorder counts with the plain loops.
namespace stereotlm::fpga {
namespace {

TEST(TileGrid, HasATileForEachGroupUpToTheMost) {
  CoreConfig config;
  config.width = 64;
  config.height = 48;
  const FrameGeometry geometry(config);
  const TileGrid whole(geometry, 16 * 48);
  EXPECT_EQ(whole.columns * whole.rows, 16U * 48U);
  EXPECT_EQ(whole.columns_of_tile, 4U);
  EXPECT_EQ(whole.rows_of_tile, 1U);
  const TileGrid larger(geometry, 16 * 48 - 1);
  EXPECT_EQ(larger.columns, 16U);
  EXPECT_EQ(larger.rows, 24U);
  EXPECT_EQ(larger.rows_of_tile, 2U);
  const TileGrid one(geometry, 1);
  EXPECT_EQ(one.columns * one.rows, 1U);
  EXPECT_GE(one.columns_of_tile, 64U);
}

TEST(TileGrid, MakesTilesOfRowsThatLeaveAtOnce) {
  CoreConfig config;
  config.width = 64;
  config.height = 45;
  config.rows = 8;
  const TileGrid grid(FrameGeometry(config), 48);
  EXPECT_EQ(grid.rows_of_tile, 8U);
  EXPECT_EQ(grid.rows, 6U);
  EXPECT_EQ(grid.columns, 8U);  // 8 pixels wide, as high
}

}  // namespace
}  // namespace stereotlm::fpga
