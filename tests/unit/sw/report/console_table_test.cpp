#include "sw/report/console_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace stereotlm::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

platform::Statistics two_banks() {
  platform::Statistics statistics;
  statistics.board = "small";
  statistics.fidelity = "cycle";
  statistics.frames = 2;
  statistics.cycles = 2000;
  statistics.frame_cycles = {1016, 1018};
  statistics.frames_per_second.core = 39331.5;
  statistics.bound = {40000, "left_pixel"};
  statistics.banks = {{"image", 1500, 0, 1500, 0, 500, 3, 0.75, 120},
                      {"out", 0, 20, 20, 0, 1980, 0, 0.01, 1.6}};
  statistics.blame = {{"left_lut", "image", "left_pixel", 40},
                      {"left_pixel", "out", "turnaround", 250},
                      {"right_lut", "out", "result", 250}};
  return statistics;
}

TEST(ConsoleTable, ShowsRatesBanksAndTheWorstStall) {
  EXPECT_EQ(console_table(two_banks(), 40, std::nullopt),
            "core          39331.500 frames/s   1017 cycles a frame, 2 frames\n"
            "bound         40000.000 frames/s   limited by left_pixel\n"
            "bank                  reads         writes   use %      MB/s peak MB/s\n"
            "image                  1500              0   75.00    120.00    160.00\n"
            "out                       0             20    1.00      1.60    160.00\n"
            "worst stall  left_pixel on out lost 250 cycles (12.50 %) to turnaround\n");
}

TEST(ConsoleTable, ShowsTheAccuracyIfThereIsGroundTruth) {
  EXPECT_THAT(
      console_table(two_banks(), 40, Accuracy{4.256, 2, 81.5}),
      HasSubstr("\naccuracy     off by more than 1: 4.26 %, by more than 2: 2.00 %, answered: 81.50 %\n"));
  EXPECT_THAT(console_table(two_banks(), 40, Accuracy{std::nullopt, std::nullopt, 0}),
              HasSubstr("\naccuracy     off by more than 1: n/a, by more than 2: n/a, answered: 0.00 %\n"));
  EXPECT_THAT(console_table(two_banks(), 40, std::nullopt), Not(HasSubstr("accuracy")));
}

TEST(ConsoleTable, SaysSoIfNothingStalled) {
  platform::Statistics statistics = two_banks();
  statistics.blame.clear();
  EXPECT_THAT(console_table(statistics, 40, std::nullopt), HasSubstr("\nworst stall  none\n"));
}

TEST(ConsoleTable, TakesThePeakFromTheClock) {
  EXPECT_THAT(console_table(two_banks(), 62.5, std::nullopt), HasSubstr("    120.00    250.00\n"));
}

TEST(ConsoleTable, StaysWithinAHundredColumns) {
  platform::Statistics statistics = two_banks();
  statistics.banks[0].name = std::string(300, 'b');
  statistics.banks[0].reads = 9'999'999'999'999;
  statistics.blame = {{"right_pixel", std::string(300, 'b'), "right_pixel", 999'999'999'999'999}};
  statistics.cycles = 999'999'999'999'999;
  statistics.bound.core_limited_by = std::string(300, 'l');
  std::istringstream lines(console_table(statistics, 1000, Accuracy{100, 100, 100}));
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    EXPECT_LE(line.size(), 100U) << line;
    ++count;
  }
  EXPECT_EQ(count, 7);
}

}  // namespace
}  // namespace stereotlm::report
