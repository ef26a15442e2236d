#include "models/clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>

#include "models/kernel_time.h"
#include "tests/support/plain_clock.h"

namespace stereotlm {
namespace {

// The contract's definition in whole numbers.
test::PlainClock definition(const std::string& mhz) { return test::PlainClock(test::plain_number(mhz)); }

TEST(Clock, RoundsEachEdgeOfTheDecimalFrequencyToTheNearestPsAndHalvesUp) {
  struct Edge {
    double mhz;
    std::uint64_t edge;
    std::uint64_t ps;
  };
  for (const auto& [mhz, edge, ps] :
       {Edge{40, 0, 0}, Edge{40, 1, 25'000}, Edge{40, 1'000'000'000, 25'000'000'000'000},
        Edge{33.333, 1, 30'000},                                                 // 30000.30
        Edge{33.333, 2, 60'001},                                                 // 60000.60
        Edge{33.333, 3, 90'001}, Edge{33.333, 4, 120'001}, Edge{640, 1, 1'563},  // 1562.5
        Edge{640, 2, 3'125}, Edge{640, 3, 4'688},
        // The doubles next to 25.6 and 13.7047 would put these edges 1 ps earlier.
        Edge{25.6, 1, 39'063}, Edge{13.7047, 930'277, 67'880'143'309}}) {
    EXPECT_EQ(Clock(mhz).edge_ps(edge), ps) << mhz << " MHz, " << edge;
  }
}

TEST(Clock, DoesNotDrift) {
  for (const char* mhz : {"33.333", "29.97", "66.667", "1000"}) {
    for (const std::uint64_t edge : {1U, 7U, 999'983U, 999'999'999U, 1'000'000'000U})
      EXPECT_EQ(Clock(std::stod(mhz)).edge_ps(edge), definition(mhz).edge(edge)) << mhz << " MHz, " << edge;
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

TEST(Clock, EqualsTheDefinitionAtRandomEdgesAndTimes) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> rate(1, 1000);
  for (int i = 0; i < 400; ++i) {
    constexpr const char* kUsual[] = {"33.333", "66.667", "66.666", "40",      "640",
                                      "29.97",  "1",      "1000",   "999.999", "0.001"};
    const std::string mhz = i < 10 ? kUsual[i] : std::to_string(rate(random));
    const Clock clock(std::stod(mhz));
    for (int j = 0; j < 500; ++j) {
      const std::uint64_t edge = random() >> (24 + random() % 40);  // up to 2^40
      const std::uint64_t time = definition(mhz).edge(edge);
      ASSERT_EQ(clock.edge_ps(edge), time) << mhz << " MHz, edge " << edge;
      for (const std::uint64_t at :
           {time, time + 1, time - std::min<std::uint64_t>(time, 1), time + random() % 1'000'000}) {
        ASSERT_EQ(clock.edge_at_or_after(at), definition(mhz).first_edge(at)) << mhz << " MHz, " << at;
      }
    }
  }
}

// Periods of nearly 1562.5 ps, and of 2^k / 3 ps: many edges lie at half a ps, or near it.
TEST(Clock, RoundsEdgesNearAHalfAsDefined) {
  for (const char* mhz : {"640", "640.00000000004096", "639.99999999995904", "25.6", "1.5", "91.552734375"}) {
    const Clock clock(std::stod(mhz));
    for (std::uint64_t edge = 0; edge < 3'000; ++edge) {
      for (const std::uint64_t far : {std::uint64_t{0}, std::uint64_t{1} << 20U, std::uint64_t{1} << 38U}) {
        ASSERT_EQ(clock.edge_ps(far + edge), definition(mhz).edge(far + edge))
            << mhz << " MHz, " << far + edge;
      }
    }
  }
}

TEST(Clock, HasTheEdgesOfAClockWithTheSameFrequency) {
  for (const double mhz : {40.0, 62.5, 33.333}) EXPECT_TRUE(Clock(mhz).has_edges_of(Clock(mhz))) << mhz;
  EXPECT_FALSE(Clock(40).has_edges_of(Clock(80)));
  EXPECT_FALSE(Clock(80).has_edges_of(Clock(40)));
  EXPECT_FALSE(Clock(33.333).has_edges_of(Clock(33.334)));
}

TEST(Clock, DividesAClockWhoseFrequencyIsAMultiple) {
  EXPECT_TRUE(Clock(33.333).divides(Clock(33.333)));
  EXPECT_TRUE(Clock(20).divides(Clock(40)));
  EXPECT_FALSE(Clock(40).divides(Clock(20)));
  EXPECT_FALSE(Clock(66).divides(Clock(40)));
  EXPECT_FALSE(Clock(33.333).divides(Clock(40)));
  EXPECT_TRUE(Clock(0.001).divides(Clock(1000)));
}

TEST(Clock, RefusesAFrequencyOutsideItsRange) {
  for (const double mhz : {0.0, -40.0, 0.000999, 1000.001}) EXPECT_THROW(Clock{mhz}, std::invalid_argument);
}

TEST(Clock, CountsSimulatedTimeInPicoseconds) {
  EXPECT_EQ(kernel_time::to_time(25'000), sc_core::sc_time(25, sc_core::SC_NS));
  EXPECT_EQ(kernel_time::to_ps(sc_core::sc_time(3, sc_core::SC_US)), 3'000'000U);
}

}  // namespace
}  // namespace stereotlm
