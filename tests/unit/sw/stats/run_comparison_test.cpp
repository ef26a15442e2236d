#include "sw/stats/run_comparison.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "sw/files/whole_file.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::stats {
namespace {

using fpga::RowEnd;
using fpga::RowProfile;

// Rows of the given cycles. The left pixel port is stalled in every tenth cycle.
RowProfile profile(const std::vector<std::uint64_t>& cycles) {
  RowProfile rows;
  RowEnd end = {0, std::vector<std::uint64_t>(fpga::kCoreGroupCount)};
  for (const std::uint64_t row : cycles) {
    end.cycles += row;
    end.stalls[2] += row / 10;
    rows.push_back(end);
  }
  return rows;
}

// "first..last: cycles, least..most, stalls of the left pixel port; " of each range
std::string text_of(const std::vector<RowComparison::Range>& ranges) {
  std::string text;
  for (const RowComparison::Range& range : ranges) {
    text += fmt::format("{}..{}: {}, {}..{}, {}; ", range.first_row, range.last_row, range.cycles,
                        range.least, range.most, range.stalls[2]);
  }
  return text;
}

TEST(RowComparison, JoinsNeighbouringRowsThatCostTheSame) {
  RowComparison rows;
  rows.add(profile({10, 20, 30, 40, 50, 60, 70}), profile({10, 30, 40, 50, 50, 60, 50}));
  EXPECT_EQ(text_of(rows.ranges(2)), "1..3: 30, 10..10, 3; 6..6: -20, -20..-20, -2; ");
}

TEST(RowComparison, JoinsRowsToBandsWhereTheRangesAreTooMany) {
  RowComparison rows;
  rows.add(profile({10, 10, 10, 10, 10, 10, 10}), profile({20, 10, 10, 10, 40, 20, 0}));
  EXPECT_EQ(text_of(rows.ranges(4)),
            "0..0: 10, 10..10, 1; 4..4: 30, 30..30, 3; 5..5: 10, 10..10, 1; 6..6: -10, -10..-10, -1; ");
  EXPECT_EQ(text_of(rows.ranges(3)), "0..1: 10, 0..10, 1; 4..6: 30, -10..30, 3; ");
}

TEST(RowComparison, KeepsRangesWhoseDifferencesCancel) {
  RowComparison rows;
  rows.add(profile({10, 12, 10, 10, 10, 10}), profile({12, 10, 10, 10, 13, 10}));
  EXPECT_EQ(text_of(rows.ranges(3)), "0..0: 2, 2..2, 0; 1..1: -2, -2..-2, 0; 4..4: 3, 3..3, 0; ");
  EXPECT_EQ(text_of(rows.ranges(2)), "0..2: 0, -2..2, 0; 3..5: 3, 0..3, 0; ");
}

TEST(RowComparison, HasRangesThatSumUpToAllRows) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint64_t> few(0, 2);
  const auto made_up = [&] {
    RowProfile rows(23);
    RowEnd end = {0, std::vector<std::uint64_t>(fpga::kCoreGroupCount)};
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
    for (const RowComparison::Range& range : rows.ranges(static_cast<std::size_t>(repetition % 20) + 1)) {
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

constexpr const char* kHead =
    "frame,row,a_cycles,b_cycles,a_left_lut_stall_cycles,a_right_lut_stall_cycles,a_left_pixel_stall_cycles,"
    "a_right_pixel_stall_cycles,a_result_stall_cycles,b_left_lut_stall_cycles,b_right_lut_stall_cycles,"
    "b_left_pixel_stall_cycles,b_right_pixel_stall_cycles,b_result_stall_cycles\n";

TEST(RowsCsv, HasALineForEachFrameAndRow) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  RowsCsv csv(path);
  const std::vector<std::uint64_t> none(fpga::kCoreGroupCount);
  csv.add({{10, {1, 2, 3, 4, 5}}, {25, {1, 2, 3, 4, 6}}}, {{11, none}, {26, {0, 7, 0, 0, 0}}});
  csv.add({{9, none}, {18, none}}, {{9, none}, {18, none}});
  EXPECT_FALSE(std::filesystem::exists(path));
  csv.commit();
  EXPECT_EQ(files::read_whole_file(path), std::string(kHead) +
                                              "0,0,10,11,1,2,3,4,5,0,0,0,0,0\n"
                                              "0,1,15,15,0,0,0,0,1,0,7,0,0,0\n"
                                              "1,0,9,9,0,0,0,0,0,0,0,0,0,0\n"
                                              "1,1,9,9,0,0,0,0,0,0,0,0,0,0\n");
}

// Two runs may have different numbers of lanes.
TEST(RowsCsv, AddsTheStallsOfTheLanesOfAPortGroup) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  RowsCsv csv(path);
  csv.add({{10, {1, 2, 3, 4, 5}}}, {{11, {1, 2, 10, 20, 100, 200, 1000, 2000, 5}}});
  csv.commit();
  EXPECT_EQ(files::read_whole_file(path), std::string(kHead) + "0,0,10,11,1,2,3,4,5,3,30,300,3000,5\n");
}

}  // namespace
}  // namespace stereotlm::stats
