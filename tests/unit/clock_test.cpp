#include "models/clock.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace stereotlm {
namespace {

// round(k * 10^6 / f) ps, halves up, in whole numbers: f is `thousandths_of_mhz` / 1000 MHz.
std::uint64_t exact_edge_ps(std::uint64_t edge, std::uint64_t thousandths_of_mhz) {
  return (2 * edge * 1'000'000'000 + thousandths_of_mhz) / (2 * thousandths_of_mhz);
}

TEST(Clock, PutsTheEdgesOfAWholePeriodAtItsMultiples) {
  const Clock clock(40);
  EXPECT_EQ(clock.edge_ps(0), 0U);
  EXPECT_EQ(clock.edge_ps(1), 25'000U);
  EXPECT_EQ(clock.edge_ps(1'000'000'000), 25'000'000'000'000U);
}

TEST(Clock, RoundsAnEdgeToTheNearestPicosecond) {
  const Clock clock(33.333);
  EXPECT_EQ(clock.edge_ps(1), 30'000U);  // 30000.30
  EXPECT_EQ(clock.edge_ps(2), 60'001U);  // 60000.60
  EXPECT_EQ(clock.edge_ps(3), 90'001U);  // 90000.90
  EXPECT_EQ(clock.edge_ps(4), 120'001U);
}

TEST(Clock, RoundsAHalfPicosecondUp) {
  const Clock clock(640);  // 1562.5 ps
  EXPECT_EQ(clock.edge_ps(1), 1'563U);
  EXPECT_EQ(clock.edge_ps(2), 3'125U);
  EXPECT_EQ(clock.edge_ps(3), 4'688U);
}

TEST(Clock, DoesNotDrift) {
  for (const std::uint64_t edge : {1U, 7U, 999'983U, 999'999'999U, 1'000'000'000U}) {
    EXPECT_EQ(Clock(33.333).edge_ps(edge), exact_edge_ps(edge, 33'333)) << edge;
    EXPECT_EQ(Clock(29.97).edge_ps(edge), exact_edge_ps(edge, 29'970)) << edge;
    EXPECT_EQ(Clock(66.667).edge_ps(edge), exact_edge_ps(edge, 66'667)) << edge;
    EXPECT_EQ(Clock(1000).edge_ps(edge), exact_edge_ps(edge, 1'000'000)) << edge;
  }
}

TEST(Clock, FindsTheEdgeAtATimeAndTheNextOneAPicosecondLater) {
  for (const double mhz : {40.0, 33.333, 29.97, 640.0, 1.0, 1000.0}) {
    const Clock clock(mhz);
    EXPECT_EQ(clock.edge_at_or_after(0), 0U) << mhz;
    EXPECT_EQ(clock.edge_at_or_after(1), 1U) << mhz;
    for (const std::uint64_t edge : {1U, 2U, 3U, 4U, 5U, 999U, 1'000'000'000U}) {
      const std::uint64_t time = clock.edge_ps(edge);
      EXPECT_EQ(clock.edge_at_or_after(time - 1), edge) << mhz;
      EXPECT_EQ(clock.edge_at_or_after(time), edge) << mhz;
      EXPECT_EQ(clock.edge_at_or_after(time + 1), edge + 1) << mhz;
    }
  }
}

TEST(Clock, HasTheEdgesOfOneWithItsPeriodInWholePicoseconds) {
  EXPECT_TRUE(Clock(40).has_edges_of(Clock(40)));
  EXPECT_TRUE(Clock(62.5).has_edges_of(Clock(62.5)));
  EXPECT_FALSE(Clock(40).has_edges_of(Clock(80)));
  EXPECT_FALSE(Clock(80).has_edges_of(Clock(40)));
  // Not known of a period that is none.
  EXPECT_FALSE(Clock(33.333).has_edges_of(Clock(33.333)));
  EXPECT_FALSE(Clock(33.333).has_edges_of(Clock(66.666)));
}

TEST(Clock, CountsSimulatedTimeInPicoseconds) {
  EXPECT_EQ(Clock::to_time(25'000), sc_core::sc_time(25, sc_core::SC_NS));
  EXPECT_EQ(Clock::to_ps(sc_core::sc_time(3, sc_core::SC_US)), 3'000'000U);
}

}  // namespace
}  // namespace stereotlm
