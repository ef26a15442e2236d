#include <gtest/gtest.h>

#include "models/area/area.h"

namespace stereotlm::area {
namespace {

constexpr Device kXc2v6000 = kDevices[0];

Area total_of(const Resources& resources) { return total({{"parts", 1, resources}}, kXc2v6000); }

TEST(Device, IsFoundByItsName) {
  const Device* device = find_device("xc2v6000");
  ASSERT_NE(device, nullptr);
  EXPECT_EQ(device->slices, 33'792);
  EXPECT_EQ(device->block_rams, 144);
  EXPECT_EQ(device->multipliers, 144);
  EXPECT_EQ(find_device("xc2v6000 "), nullptr);
  EXPECT_EQ(find_device(""), nullptr);
}

TEST(AreaItem, SharesPlacesBetweenLutsAndTheirFlipFlops) {
  EXPECT_EQ((Item{"parts", 1, {10, 10, 0, 0}}).lut_equivalents(), 10);
  EXPECT_EQ((Item{"parts", 1, {10, 11, 0, 0}}).lut_equivalents(), 11);
  EXPECT_EQ((Item{"parts", 1, {0, 0, 5, 6}}).lut_equivalents(), 0);
}

TEST(AreaTotal, SharesNoPlacesBetweenItems) {
  const Area area = total({{"one", 1, {10, 0, 1, 2}}, {"other", 3, {0, 20, 3, 4}}}, kXc2v6000);
  EXPECT_EQ(area.lut_equivalents, 30);
  EXPECT_EQ(area.luts, 10);
  EXPECT_EQ(area.flip_flops, 20);
  EXPECT_EQ(area.block_rams, 4);
  EXPECT_EQ(area.multipliers, 6);
}

TEST(AreaTotal, RoundsSlicesUp) {
  EXPECT_EQ(total({}, kXc2v6000).slices, 0);
  EXPECT_EQ(total_of({1}).slices, 1);
  EXPECT_EQ(total_of({10'000}).slices, 6218);
  EXPECT_EQ(total_of({10'001}).slices, 6219);
}

TEST(AreaTotal, IsAShareOfTheDevice) {
  const Area area = total_of({10'000, 0, 36, 72});
  EXPECT_DOUBLE_EQ(area.slices_percent, 100.0 * 6218 / 33'792);
  EXPECT_DOUBLE_EQ(area.block_rams_percent, 25);
  EXPECT_DOUBLE_EQ(area.multipliers_percent, 50);
}

TEST(AreaTotal, IsAShareOfEachResourceOfItsOwnNumber) {
  constexpr Device kMade = {"made", 1000, 50, 200};
  const Area area = total({{"parts", 1, {0, 0, 10, 10}}}, kMade);
  EXPECT_DOUBLE_EQ(area.block_rams_percent, 20);
  EXPECT_DOUBLE_EQ(area.multipliers_percent, 5);
}

TEST(AreaTotal, FitsUpToTheLastOfEachResource) {
  const Area full = total_of({54'345, 0, 144, 144});
  EXPECT_EQ(full.slices, 33'792);
  EXPECT_TRUE(full.fits());
  EXPECT_FALSE(total_of({54'347}).fits());
  EXPECT_FALSE(total_of({0, 0, 145, 0}).fits());
  EXPECT_FALSE(total_of({0, 0, 0, 145}).fits());
}

}  // namespace
}  // namespace stereotlm::area
