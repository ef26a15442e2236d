#include "models/fpga/burst_trust.h"

#include <gtest/gtest.h>

namespace stereotlm::fpga {
namespace {

void miss(BurstTrust& trust, int bursts) {
  for (int burst = 0; burst < bursts; ++burst) trust.note(false);
}

TEST(BurstTrust, EndsAfterManyMisses) {
  BurstTrust trust;
  miss(trust, 255);
  EXPECT_TRUE(trust.expects_known());
  miss(trust, 1);
  EXPECT_FALSE(trust.expects_known());
}

TEST(BurstTrust, GrowsByTwoWithAKnownBurstUpToALimit) {
  BurstTrust trust;
  trust.note(true);
  miss(trust, 254);
  trust.note(true);
  miss(trust, 3);
  EXPECT_TRUE(trust.expects_known());
  miss(trust, 1);
  EXPECT_FALSE(trust.expects_known());
}

TEST(BurstTrust, ReturnsForEightBurstsAfter2048) {
  BurstTrust trust;
  miss(trust, 256);
  for (int round = 0; round < 2; ++round) {
    for (int burst = 1; burst < 2048; ++burst) ASSERT_FALSE(trust.expects_known()) << burst;
    EXPECT_TRUE(trust.expects_known());
    miss(trust, 7);
    EXPECT_TRUE(trust.expects_known());
    miss(trust, 1);
  }
}

}  // namespace
}  // namespace stereotlm::fpga
