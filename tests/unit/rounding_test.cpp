#include "models/rounding.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stereotlm {
namespace {

TEST(RoundedIfCertain, IsTheNearestWholeNumber) {
  EXPECT_EQ(rounded_if_certain(0), 0U);
  EXPECT_EQ(rounded_if_certain(0.4), 0U);
  EXPECT_EQ(rounded_if_certain(0.6), 1U);
  EXPECT_EQ(rounded_if_certain(1e9 + 0.499), 1'000'000'000U);
  EXPECT_EQ(rounded_if_certain(1e9 + 0.501), 1'000'000'001U);
}

TEST(RoundedIfCertain, IsUnknownNearAHalf) {
  EXPECT_EQ(rounded_if_certain(0.5), std::nullopt);
  for (const double half : {1.5, 3'000'000.5, 1e12 + 0.5}) {
    EXPECT_EQ(rounded_if_certain(half), std::nullopt);
    EXPECT_EQ(rounded_if_certain(half * (1 - 0x1p-51)), std::nullopt);
    EXPECT_EQ(rounded_if_certain(half * (1 + 0x1p-51)), std::nullopt);
    EXPECT_EQ(rounded_if_certain(half * (1 - 0x1p-48)), static_cast<std::uint64_t>(half));
    EXPECT_EQ(rounded_if_certain(half * (1 + 0x1p-48)), static_cast<std::uint64_t>(half) + 1);
  }
}

TEST(RoundedIfCertain, IsUnknownForLargeNumbers) {
  EXPECT_EQ(rounded_if_certain(0x1p47), std::uint64_t{1} << 47U);
  EXPECT_EQ(rounded_if_certain(0x1p48), std::nullopt);
  EXPECT_EQ(rounded_if_certain(1e19), std::nullopt);
}

}  // namespace
}  // namespace stereotlm
