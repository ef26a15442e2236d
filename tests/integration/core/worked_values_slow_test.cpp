#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/integration/core/worked_values.h"

// Worked values at the end of contract section 2, through all modules, on the presets and with `--set`: those
// that take longer than ten seconds under the sanitizers.
namespace stereotlm::test {
namespace {

TEST_P(CoreWorkedValues, Hold) { expect_worked_values(GetParam()); }

// The paper's board without filter.
WorkedFrame plain(const std::string& name, std::vector<std::string> sets, std::uint64_t frame_cycles,
                  std::vector<std::string> blame = {}) {
  sets.emplace_back("matcher.filter=none");
  return {name, "fpl2003", sets, frame_cycles, std::move(blame)};
}

// Joint tables in bank0, all else in bank1, and the word cache.
std::vector<std::string> in_two_banks() {
  return {
      "allocation={left_image: bank1, right_image: bank1, disparity: bank1, left_lut: bank0, right_lut: "
      "bank0}",
      "fpga.tables=joint", "fpga.pixel_cache=word"};
}

INSTANTIATE_TEST_SUITE_P(
    Contract, CoreWorkedValues,
    testing::Values(
        plain("Window9", {"matcher.window=9"}, 2'765'568),
        plain("Window11", {"matcher.window=11"}, 3'380'145),
        plain("Window13", {"matcher.window=13"}, 3'994'726),
        plain("Window15", {"matcher.window=15"}, 4'609'311), WorkedFrame{"Log7", "fpl2003", {}, 2'151'016},
        WorkedFrame{"Window5WithLog7", "fpl2003", {"matcher.window=5"}, 1'539'641},
        plain("Units40", {"matcher.units=40"}, 4'301'969), plain("Units27", {"matcher.units=27"}, 6'452'943),
        plain("TableInABankOfItsImage", {"allocation.left_lut=bank0"}, 4'288'597,
              {"left_lut in bank0 by left_pixel: 2137602"}),
        plain("TableInABankOfItsImageByAge", {"allocation.left_lut=bank0", "fpga.arbitration=age"}, 4'287'317,
              {"left_lut in bank0 by left_pixel: 2136322", "left_pixel in bank0 by left_lut: 2135042"}),
        plain("ResultInABankOfAnImage", {"allocation.disparity=[bank0, bank0]"}, 2'227'635,
              {"left_pixel in bank0 by result: 76640"}),
        plain("TablesInTheBanksOfTheirImagesWithWordCache",
              {"allocation.left_lut=bank0", "allocation.right_lut=bank2", "fpga.pixel_cache=word"}, 2'685'395,
              {"left_lut in bank0 by left_pixel: 534400", "right_lut in bank2 by right_pixel: 534400"}),
        plain("TwoBanks", in_two_banks(), 2'151'002, {"right_pixel in bank1 by left_pixel: 7"}),
        WorkedFrame{"TwoBanksWithLog7",
                    "fpl2003",
                    in_two_banks(),
                    2'151'023,
                    {"right_pixel in bank1 by left_pixel: 7"}},
        plain("ResultInAQdrBankOfAnImage",
              {"allocation.disparity=[bank0, bank0]", "ssram.banks.bank0.kind=qdr"}, 2'150'995),
        WorkedFrame{"ResultInASyncBurstBankOfAnImage",
                    "fpl2003-syncburst",
                    {"matcher.filter=none", "allocation.disparity=[bank0, bank0]"},
                    2'534'153,
                    {"left_pixel in bank0 by result: 76640", "left_pixel in bank0 by turnaround: 306518",
                     "result in bank0 by turnaround: 152960"}}),
    name_of);

TEST(CoreWorkedValuesOfTwoBanks, HoldWithThePassesOfThePixelPort) {
  const auto statistics = expect_worked_values(
      plain("TwoBanks", in_two_banks(), 2'151'002, {"right_pixel in bank1 by left_pixel: 7"}));
  EXPECT_EQ(statistics.ports[2].name, "left_pixel");
  EXPECT_EQ(statistics.ports[2].grants, 535'680U);
  EXPECT_EQ(statistics.ports[2].passed_cycles, 1'614'720U);
  EXPECT_EQ(statistics.ports[1].name, "right_lut");
  EXPECT_EQ(statistics.ports[1].idle_cycles, statistics.cycles);
}

TEST(CoreWorkedValues7x7, HoldWithThePortStatesOfTheTablePort) {
  const auto statistics = expect_worked_values(plain("Window7", {}, 2'150'995));
  const platform::PortStatistics& port = statistics.ports.front();
  EXPECT_EQ(port.name, "left_lut");
  EXPECT_EQ(port.grants, 2'142'720U);
  EXPECT_EQ(port.passed_cycles, 7'680U);
  EXPECT_EQ(port.idle_cycles, 579U);
  EXPECT_EQ(port.stall_cycles + port.blocked_cycles + port.starved_cycles, 0U);
  EXPECT_EQ(statistics.cycles, 2'150'995U - 16U);
}

}  // namespace
}  // namespace stereotlm::test
