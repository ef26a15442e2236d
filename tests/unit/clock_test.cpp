#include "models/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <random>

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

// The definition in extended precision, without the short ways.
std::uint64_t plain_edge_ps(std::uint64_t edge, double mhz) {
  return static_cast<std::uint64_t>(
      std::floor(static_cast<long double>(edge) * 1e6L / static_cast<long double>(mhz) + 0.5L));
}
std::uint64_t plain_edge_at_or_after(std::uint64_t time_ps, double mhz) {
  auto edge =
      static_cast<std::uint64_t>(static_cast<long double>(time_ps) * static_cast<long double>(mhz) / 1e6L);
  while (edge > 0 && plain_edge_ps(edge - 1, mhz) >= time_ps) --edge;
  while (plain_edge_ps(edge, mhz) < time_ps) ++edge;
  return edge;
}

TEST(Clock, TakesNoShortWayPastTheDefinition) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> rate(1, 1000);
  for (int i = 0; i < 400; ++i) {
    constexpr double kUsual[] = {33.333, 66.667, 66.666, 40, 640, 29.97, 1, 1000, 999.999, 133.3333};
    const double mhz = i < 10 ? kUsual[i] : rate(random);
    const Clock clock(mhz);
    for (int j = 0; j < 500; ++j) {
      const std::uint64_t edge = random() >> (24 + random() % 40);  // up to 2^40
      const std::uint64_t time = plain_edge_ps(edge, mhz);
      ASSERT_EQ(clock.edge_ps(edge), time) << mhz << " MHz, edge " << edge;
      for (const std::uint64_t at :
           {time, time + 1, time - std::min<std::uint64_t>(time, 1), time + random() % 1'000'000}) {
        ASSERT_EQ(clock.edge_at_or_after(at), plain_edge_at_or_after(at, mhz)) << mhz << " MHz, " << at;
      }
    }
  }
}

// 1562.5 ps, and 2^k / 3 ps, of which many edges lie near a half.
TEST(Clock, RoundsEdgesNearAHalfAsDefined) {
  for (const double mhz : {640.0, 1e6 / 1562.4999999999, 1e6 / 1562.5000000001, 1.5, 3e6 / 32768}) {
    const Clock clock(mhz);
    for (std::uint64_t edge = 0; edge < 3'000; ++edge) {
      for (const std::uint64_t far : {std::uint64_t{0}, std::uint64_t{1} << 20U, std::uint64_t{1} << 38U}) {
        ASSERT_EQ(clock.edge_ps(far + edge), plain_edge_ps(far + edge, mhz)) << mhz << " MHz, " << far + edge;
      }
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
