#include "sw/stats/console_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace stereotlm::stats {
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
  statistics.bound.core = 40000;
  statistics.bound.core_limited_by = "left_pixel";
  statistics.banks = {{"bank0", 1500, 0, 1500, 0, 500, 3, 0.75, 120},
                      {"bank1", 0, 20, 20, 0, 1980, 0, 0.01, 1.6}};
  statistics.blame = {{"left_lut", "bank0", "left_pixel", 40},
                      {"left_pixel", "bank1", "turnaround", 250},
                      {"right_lut", "bank1", "result", 250}};
  return statistics;
}

platform::Statistics in_a_computer() {
  platform::Statistics statistics = two_banks();
  statistics.frames_per_second.system = 17.5;
  statistics.frames_per_second.steady = {17.98, 0.25, 12};
  statistics.bound.system = 29.97;
  statistics.bound.system_limited_by = "camera";
  platform::ComputerStatistics& computer = statistics.computer.emplace();
  computer.pci_clocks = 10'000;
  computer.pci_busy_clocks = 2'500;
  computer.pci_masters = {{"host", 10, 20, 0}, {"left_capture", 100, 3000, 3333}};
  computer.posted_words = 3000;
  computer.dma_words = 1000;
  computer.local_clocks = 20'000;
  computer.local_busy_clocks = 5'000;
  computer.cameras = {{"left", 10, 6, 4, 80, 3, 1, 0}, {"right", 10, 6, 4, 0, 2, 1, 1}};
  computer.capture_to_host_ms = {77.5, 80, 90.25, 99, 100};
  return statistics;
}

platform::BoardConfig clocks(double fpga_mhz, double pci_mhz, double local_mhz, int pci_width_bits = 32) {
  platform::BoardConfig board;
  board.fpga.clock_mhz = fpga_mhz;
  board.pci.clock_mhz = pci_mhz;
  board.pci.width_bits = pci_width_bits;
  board.bridge.local_clock_mhz = local_mhz;
  return board;
}

TEST(ConsoleTable, ShowsTheRatesOfAPciBusOf64Bits) {
  const std::string text = console_table(in_a_computer(), clocks(40, 30, 40, 64));
  EXPECT_THAT(
      text, HasSubstr("left_capture            100           3000   15.00     36.00    240.00        1.111\n"
                      "pci bus      busy 25.00 % of its clocks\n"));
}

TEST(ConsoleTable, ShowsTheAccuracyIfThereIsGroundTruth) {
  EXPECT_THAT(
      console_table(two_banks(), {}, {std::nullopt, std::nullopt, Accuracy{4.256, 2, 81.5}}),
      HasSubstr("\naccuracy     off by more than 1: 4.26 %, by more than 2: 2.00 %, answered: 81.50 %\n"));
  EXPECT_THAT(
      console_table(two_banks(), {}, {std::nullopt, std::nullopt, Accuracy{std::nullopt, std::nullopt, 0}}),
      HasSubstr("\naccuracy     off by more than 1: n/a, by more than 2: n/a, answered: 0.00 %\n"));
  EXPECT_THAT(console_table(two_banks(), {}), Not(HasSubstr("accuracy")));
}

TEST(ConsoleTable, SaysWhereARateIsAboveItsBound) {
  platform::Statistics statistics = in_a_computer();
  statistics.computer->cameras[0].dropped_pixels = 0;
  statistics.bound.system = 17.9;
  EXPECT_THAT(
      console_table(statistics, {}),
      HasSubstr("\nsteady           17.980 ± 0.250 frames/s   over 12 frames, at its bound within the "
                "uncertainty\nfrom power-up    17.500 frames/s\nsteady bound     17.900 frames/s   "));
  statistics.bound.system = 17.4;  // below the rate from power-up
  EXPECT_THAT(console_table(statistics, {}),
              HasSubstr("\nsteady bound     17.400 frames/s over whole turns  "));
}

TEST(LostPixels, AreNamedIfThereAreAny) {
  EXPECT_EQ(lost_pixels_text(0), "");
  EXPECT_EQ(lost_pixels_text(1), "captures lose 1 pixel: pictures are torn, and disparities are wrong there");
  EXPECT_EQ(lost_pixels_text(7).substr(0, 23), "captures lose 7 pixels:");
}

TEST(ConsoleTable, ShowsThePeakOfAllPortsOfABank) {
  platform::Statistics statistics = two_banks();
  statistics.banks[0].ports = 2;
  EXPECT_THAT(console_table(statistics, {}), HasSubstr("    120.00    320.00        -\n"));
}

TEST(ConsoleTable, StaysWithinAHundredColumns) {
  platform::Statistics statistics = in_a_computer();
  statistics.bound.system = 17.4;  // below the rate from power-up
  statistics.bound.system_limited_by = std::string(300, 'l');
  statistics.computer->pci_masters[0] = {"right_capture", 9'999'999'999'999, 9'999'999'999'999, 99'999};
  statistics.computer->pci_clocks = 99'999'999'999'999;
  statistics.computer->posted_words = 9'999'999'999;
  statistics.computer->local_clocks = 99'999'999'999;
  statistics.computer->cameras[0] = {"right", 9'999'999, 9'999'999, 9'999'999, 999'999'999'999, 1, 2, 3};
  statistics.banks[0].name = std::string(300, 'b');
  statistics.banks[0].reads = 9'999'999'999'999;
  statistics.blame = {{"right_pixel", std::string(300, 'b'), "right_pixel", 9'999'999'999'999},
                      {"left_pixel", "b", "turnaround", 1}};
  statistics.cycles = 9'999'999'999'999;
  statistics.bound.core_limited_by = std::string(300, 'l');
  const std::string text =
      console_table(statistics, clocks(1000, 1000, 1000), {999999, 100, Accuracy{100, 100, 100}});
  EXPECT_THAT(text, HasSubstr("\nsteady bound     17.400 frames/s of whole pictures   limited by lll"));
  std::istringstream lines(text);
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    EXPECT_LE(line.size(), 100U) << line;
    ++count;
  }
  EXPECT_EQ(count, 24);
}

}  // namespace
}  // namespace stereotlm::stats
