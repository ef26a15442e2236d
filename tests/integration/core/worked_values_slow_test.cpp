#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/integration/core/worked_values.h"

// Worked values at the end of contract section 2, through all modules, on the presets and with `--set`: those
// that take longer than ten seconds under the sanitizers.
namespace stereotlm::test {
namespace {

using WindowCase = std::pair<int, std::uint64_t>;  // window, frame_cycles

class CoreWindow : public testing::TestWithParam<WindowCase> {};

std::string window_name(const testing::TestParamInfo<WindowCase>& info) {
  return std::to_string(info.param.first);
}

TEST_P(CoreWindow, TakesTheWorkedCyclesWithoutFilter) {
  const auto statistics =
      run_one_frame("fpl2003", {"matcher.filter=none", "matcher.window=" + std::to_string(GetParam().first)});
  EXPECT_EQ(statistics.frame_cycles, Cycles{GetParam().second});
  EXPECT_EQ(blame_of(statistics), std::vector<std::string>());
}

INSTANTIATE_TEST_SUITE_P(Contract, CoreWindow,
                         testing::Values(WindowCase{7, 2'150'995}, WindowCase{9, 2'765'568},
                                         WindowCase{11, 3'380'145}, WindowCase{13, 3'994'726},
                                         WindowCase{15, 4'609'311}),
                         window_name);

TEST(CoreWorkedValues, HoldWithLog7) {
  EXPECT_EQ(run_one_frame("fpl2003", {}).frame_cycles, Cycles{2'151'016});
}

TEST(CoreWorkedValues, HoldForWindow5WithLog7) {
  EXPECT_EQ(run_one_frame("fpl2003", {"matcher.window=5"}).frame_cycles, Cycles{1'539'641});
}

TEST(CoreWorkedValues, HoldForThePortStatesOfTheTablePort) {
  const auto statistics = run_one_frame("fpl2003", {"matcher.filter=none"});
  const platform::PortStatistics& port = statistics.ports.front();
  EXPECT_EQ(port.name, "left_lut");
  EXPECT_EQ(port.grants, 2'142'720U);
  EXPECT_EQ(port.passed_cycles, 7'680U);
  EXPECT_EQ(port.idle_cycles, 579U);
  EXPECT_EQ(port.stall_cycles + port.blocked_cycles + port.starved_cycles, 0U);
  EXPECT_EQ(statistics.cycles, 2'150'995U - 16U);
}

TEST(CoreWorkedValues, HoldWithATableInABankOfItsImage) {
  const auto statistics = run_one_frame("fpl2003", {"matcher.filter=none", "allocation.left_lut=bank0"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{4'288'597});
  EXPECT_EQ(blame_of(statistics), std::vector<std::string>{"left_lut in bank0 by left_pixel: 2137602"});
}

TEST(CoreWorkedValues, HoldWithATableInABankOfItsImageByAge) {
  const auto statistics =
      run_one_frame("fpl2003", {"matcher.filter=none", "allocation.left_lut=bank0", "fpga.arbitration=age"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{4'287'317});
  EXPECT_EQ(blame_of(statistics), (std::vector<std::string>{"left_lut in bank0 by left_pixel: 2136322",
                                                            "left_pixel in bank0 by left_lut: 2135042"}));
}

TEST(CoreWorkedValues, HoldWithTheResultInABankOfAnImage) {
  const auto statistics =
      run_one_frame("fpl2003", {"matcher.filter=none", "allocation.disparity=[bank0, bank0]"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{2'227'635});
  EXPECT_EQ(blame_of(statistics), std::vector<std::string>{"left_pixel in bank0 by result: 76640"});
}

TEST(CoreWorkedValues, HoldWithTheSameInSyncBurstBanks) {
  const auto statistics =
      run_one_frame("fpl2003-syncburst", {"matcher.filter=none", "allocation.disparity=[bank0, bank0]"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{2'534'153});
  const auto blame = blame_of(statistics);
  const auto stated = [&blame](const std::string& row) {
    return std::find(blame.begin(), blame.end(), row) != blame.end();
  };
  EXPECT_TRUE(stated("left_pixel in bank0 by turnaround: 306518")) << testing::PrintToString(blame);
  EXPECT_TRUE(stated("result in bank0 by turnaround: 152960")) << testing::PrintToString(blame);
}

}  // namespace
}  // namespace stereotlm::test
