#include "sw/report/row_comparison.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::report {
namespace {

using fpga::RowEnd;
using fpga::RowProfile;

// Rows that take so many cycles each, of which the left pixel port is stalled in every tenth.
RowProfile profile(const std::vector<std::uint64_t>& cycles) {
  RowProfile rows;
  RowEnd end;
  for (const std::uint64_t row : cycles) {
    end.cycles += row;
    end.stalls[2] += row / 10;
    rows.push_back(end);
  }
  return rows;
}

TEST(RowsAlone, AreWhatLiesBetweenTwoEnds) {
  EXPECT_TRUE(rows_alone({}).empty());
  const RowProfile rows = rows_alone(profile({105, 40, 0, 71}));
  const RowProfile expected = {
      {105, {0, 0, 10, 0, 0}}, {40, {0, 0, 4, 0, 0}}, {0, {}}, {71, {0, 0, 7, 0, 0}}};
  EXPECT_EQ(rows, expected);
}

// "first..last: sum, least..most, stalls of the left pixel port"
std::string text_of(const std::vector<RowComparison::Range>& ranges) {
  std::string text;
  for (const RowComparison::Range& range : ranges) {
    text += std::to_string(range.first_row) + ".." + std::to_string(range.last_row) + ": " +
            std::to_string(range.cycles) + ", " + std::to_string(range.least) + ".." +
            std::to_string(range.most) + ", " + std::to_string(range.stalls[2]) + "; ";
  }
  return text;
}

TEST(RowComparison, FindsNothingInTheSameRows) {
  RowComparison rows;
  rows.add(profile({10, 20}), profile({10, 20}));
  EXPECT_EQ(rows.frames(), 1U);
  EXPECT_FALSE(rows.parting());
  EXPECT_TRUE(rows.ranges(10).empty());
}

TEST(RowComparison, NamesTheFirstRowThatIsNotWholeInTheSameCycle) {
  RowComparison rows;
  rows.add(profile({10, 20, 30}), profile({10, 20, 30}));
  rows.add(profile({10, 20, 30}), profile({10, 21, 29}));
  rows.add(profile({10, 20, 30}), profile({9, 20, 30}));
  ASSERT_TRUE(rows.parting());
  EXPECT_EQ(rows.parting()->frame, 1U);
  EXPECT_EQ(rows.parting()->row, 1U);
  EXPECT_EQ(rows.parting()->cycles_a, 30U);
  EXPECT_EQ(rows.parting()->cycles_b, 31U);
}

TEST(RowComparison, PutsRowsTogetherThatCostTheSame) {
  RowComparison rows;
  rows.add(profile({10, 20, 30, 40, 50, 60, 70}), profile({10, 30, 40, 50, 50, 60, 50}));
  EXPECT_EQ(text_of(rows.ranges(2)), "1..3: 30, 10..10, 3; 6..6: -20, -20..-20, -2; ");
}

TEST(RowComparison, SumsUpTheFrames) {
  RowComparison rows;
  rows.add(profile({10, 20, 30}), profile({20, 20, 30}));
  rows.add(profile({10, 20, 30}), profile({10, 30, 20}));
  EXPECT_EQ(text_of(rows.ranges(3)), "0..1: 20, 10..10, 2; 2..2: -10, -10..-10, -1; ");
  EXPECT_EQ(rows.frames(), 2U);
}

TEST(RowComparison, HasNoRangesWhereOneFrameGainsWhatAnotherOneCosts) {
  RowComparison rows;
  rows.add(profile({10, 20}), profile({20, 10}));
  rows.add(profile({20, 10}), profile({10, 20}));
  EXPECT_TRUE(rows.parting());
  EXPECT_TRUE(rows.ranges(10).empty());
}

TEST(RowComparison, DrawsBandsWhereTheRangesAreTooMany) {
  RowComparison rows;
  rows.add(profile({10, 10, 10, 10, 10, 10, 10}), profile({20, 10, 10, 10, 40, 20, 0}));
  EXPECT_EQ(text_of(rows.ranges(4)),
            "0..0: 10, 10..10, 1; 4..4: 30, 30..30, 3; 5..5: 10, 10..10, 1; 6..6: -10, -10..-10, -1; ");
  EXPECT_EQ(text_of(rows.ranges(3)), "0..1: 10, 0..10, 1; 4..6: 30, -10..30, 3; ");
}

// Rows of 10 cycles, with so many stalls of the left table port and of the right one.
RowProfile stalled(const std::vector<std::array<std::uint64_t, 2>>& stalls) {
  RowProfile rows;
  RowEnd end;
  for (const auto& [left, right] : stalls) {
    end.cycles += 10;
    end.stalls[0] += left;
    end.stalls[1] += right;
    rows.push_back(end);
  }
  return rows;
}

std::string stalls_of(const std::vector<RowComparison::Range>& ranges) {
  std::string text;
  for (const RowComparison::Range& range : ranges) {
    text += std::to_string(range.first_row) + ".." + std::to_string(range.last_row) + ": " +
            std::to_string(range.stalls[0]) + ", " + std::to_string(range.stalls[1]) + "; ";
  }
  return text;
}

TEST(RowComparison, KeepsRowsThatTakeAsLongAndHaveOtherStalls) {
  RowComparison rows;
  rows.add(stalled({{0, 0}, {4, 0}, {4, 0}, {4, 0}, {1, 1}}),
           stalled({{0, 0}, {0, 4}, {0, 4}, {0, 5}, {1, 1}}));
  EXPECT_FALSE(rows.parting());
  ASSERT_TRUE(rows.other_stalls());
  EXPECT_EQ(rows.other_stalls()->frame, 0U);
  EXPECT_EQ(rows.other_stalls()->row, 1U);
  EXPECT_EQ(stalls_of(rows.ranges(10)), "1..2: -8, 8; 3..3: -4, 5; ");
}

TEST(RowComparison, PutsRowsOfAsManyCyclesTogetherWhereTheirStallsAreTooMany) {
  RowComparison rows;
  rows.add(stalled({{0, 0}, {0, 0}, {0, 0}}), stalled({{1, 0}, {2, 0}, {3, 0}}));
  EXPECT_EQ(stalls_of(rows.ranges(3)), "0..0: 1, 0; 1..1: 2, 0; 2..2: 3, 0; ");
  EXPECT_EQ(stalls_of(rows.ranges(2)), "0..2: 6, 0; ");
}

TEST(RowComparison, KeepsBandsInWhichOnlyStallsAreOthers) {
  RowComparison rows;
  RowProfile b = stalled({{0, 0}, {7, 0}, {0, 0}, {0, 0}});
  b[2].cycles += 1;
  b[3].cycles += 3;
  rows.add(stalled({{0, 0}, {0, 0}, {0, 0}, {0, 0}}), b);
  EXPECT_EQ(stalls_of(rows.ranges(2)), "0..1: 7, 0; 2..3: 0, 0; ");
}

TEST(RowComparison, SumsOfAllRangesAreThoseOfAllRows) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint64_t> few(0, 2);
  const auto made_up = [&] {
    RowProfile rows(23);
    RowEnd end;
    for (RowEnd& row : rows) {
      end.cycles += few(random);
      for (std::uint64_t& stalls : end.stalls) stalls += few(random) / 2;
      row = end;
    }
    return rows;
  };
  for (int repetition = 0; repetition < 200; ++repetition) {
    const RowProfile a = made_up();
    const RowProfile b = made_up();
    RowComparison rows;
    rows.add(a, b);
    RowEnd summed = a.back();
    for (const RowComparison::Range& range : rows.ranges(repetition % 20 + 1U)) {
      summed.cycles += static_cast<std::uint64_t>(range.cycles);
      for (std::size_t port = 0; port < summed.stalls.size(); ++port)
        summed.stalls[port] += static_cast<std::uint64_t>(range.stalls[port]);
    }
    EXPECT_EQ(summed, b.back());
  }
}

TEST(RowComparison, RefusesFramesOfDifferentHeights) {
  RowComparison rows;
  EXPECT_THROW(rows.add(profile({10, 20}), profile({10})), std::invalid_argument);
  rows.add(profile({10, 20}), profile({10, 20}));
  EXPECT_THROW(rows.add(profile({10}), profile({10})), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::report
