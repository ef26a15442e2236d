#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "models/area/area.h"

namespace stereotlm::area {
namespace {

const Device& kXc2v6000 = *find_device("xc2v6000");

Area total_of(const Resources& resources) { return total({{"parts", 1, resources}}, kXc2v6000); }

TEST(Device, IsFoundByItsName) {
  EXPECT_EQ(find_device("xc2v6000")->name, "xc2v6000");
  EXPECT_EQ(find_device("xc2v6000 "), nullptr);
  EXPECT_EQ(find_device(""), nullptr);
}

// The smallest device has enough of each resource; one more than it has needs the next.
TEST(Device, IsTheSmallestThatHoldsTheArea) {
  const auto name_of_smallest = [](std::int64_t slices, std::int64_t block_rams, std::int64_t multipliers) {
    Area area;
    area.slices = slices;
    area.block_rams = block_rams;
    area.multipliers = multipliers;
    const Device* const device = smallest_device(area);
    return device == nullptr ? "none" : std::string(device->name);
  };
  EXPECT_EQ(name_of_smallest(0, 0, 0), "xc2v1000");
  for (std::size_t i = 0; i < kDevices.size(); ++i) {
    const Device& device = kDevices[i];
    const std::string next = i + 1 < kDevices.size() ? std::string(kDevices[i + 1].name) : "none";
    EXPECT_EQ(name_of_smallest(device.slices, device.block_rams, device.multipliers), device.name);
    EXPECT_EQ(name_of_smallest(device.slices + 1, 0, 0), next);
    EXPECT_EQ(name_of_smallest(0, device.block_rams + 1, 0), next);
    EXPECT_EQ(name_of_smallest(0, 0, device.multipliers + 1), next);
  }
}

// Xilinx DS031.
TEST(Device, HasTheResourcesOfItsDataSheet) {
  const std::vector<std::array<std::int64_t, 3>> sheet = {
      {1000, 5'120, 40},   {1500, 7'680, 48},   {2000, 10'752, 56}, {3000, 14'336, 96},
      {4000, 23'040, 120}, {6000, 33'792, 144}, {8000, 46'592, 168}};
  ASSERT_EQ(kDevices.size(), sheet.size());
  for (const auto& [number, slices, others] : sheet) {
    const Device* const device = find_device("xc2v" + std::to_string(number));
    ASSERT_NE(device, nullptr) << number;
    EXPECT_EQ(device->slices, slices);
    EXPECT_EQ(device->block_rams, others);
    EXPECT_EQ(device->multipliers, others);
  }
}

TEST(AreaItem, SharesPlacesBetweenLutsAndTheirFlipFlops) {
  EXPECT_EQ((Item{"parts", 1, {10, 10, 0, 0}}).lut_equivalents(), 10);
  EXPECT_EQ((Item{"parts", 1, {10, 11, 0, 0}}).lut_equivalents(), 11);
  EXPECT_EQ((Item{"parts", 1, {0, 0, 5, 6}}).lut_equivalents(), 0);
}

TEST(AreaTotal, IsOfLutsOrOfFlipFlopsWhicheverAreMore) {
  const Area area = total({{"one", 1, {10, 0, 1, 2}}, {"other", 3, {0, 20, 3, 4}}}, kXc2v6000);
  EXPECT_EQ(area.lut_equivalents, 20);
  EXPECT_EQ(area.slices, 10);
  EXPECT_EQ(area.luts, 10);
  EXPECT_EQ(area.flip_flops, 20);
  EXPECT_EQ(area.block_rams, 4);
  EXPECT_EQ(area.multipliers, 6);
}

TEST(AreaTotal, RoundsSlicesUp) {
  EXPECT_EQ(total({}, kXc2v6000).slices, 0);
  EXPECT_EQ(total_of({1}).slices, 1);
  EXPECT_EQ(total_of({10'000}).slices, 5000);
  EXPECT_EQ(total_of({10'001}).slices, 5001);
}

TEST(AreaTotal, IsAShareOfTheDevice) {
  const Area area = total_of({10'000, 0, 36, 72});
  EXPECT_DOUBLE_EQ(area.slices_percent, 100.0 * 5000 / 33'792);
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
  const Area full = total_of({67'584, 0, 144, 144});
  EXPECT_EQ(full.slices, 33'792);
  EXPECT_TRUE(full.fits());
  EXPECT_FALSE(total_of({67'585}).fits());
  EXPECT_FALSE(total_of({0, 0, 145, 0}).fits());
  EXPECT_FALSE(total_of({0, 0, 0, 145}).fits());
}

// The rows of the paper's Table 2: images of 640x480, windows of 7x7, tables and filters for both sides.
TEST(AreaTotal, IsNearThePapersTable2AtFullPacking) {
  struct Row {
    int disparities;
    double printed_percent;
    double documented_error;  // percentage points
  };
  for (const Row& row : {Row{80, 21, 3.94}, Row{160, 43, 2.51}, Row{200, 54, 1.64}}) {
    fpga::CoreConfig core;
    core.disparities = row.disparities;
    const Area area = total(items(core), kXc2v6000);
    EXPECT_NEAR(area.slices_percent - row.printed_percent, row.documented_error, 0.005);
  }
}

}  // namespace
}  // namespace stereotlm::area
