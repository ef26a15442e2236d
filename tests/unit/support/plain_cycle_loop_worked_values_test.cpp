#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/support/plain_cycle_loop.h"

// The worked values at the end of contract section 2, to the cycle.
namespace stereotlm::test {
namespace {

constexpr int kLog7Half = 3;

// 640x480, D = 80, n = 7, no filter, `column`, a bank for each buffer.
PlainCycleInput paper_board() {
  PlainCycleInput input;
  input.width = 640;
  input.height = 480;
  input.window = 7;
  input.disparities = 80;
  input.banks.resize(8);
  input.left_image = {0, 1};
  input.right_image = {2, 3};
  input.disparity = {4, 5};
  input.left_lut = 6;
  input.right_lut = 7;
  return input;
}

std::uint64_t first_frame_cycles(const PlainCycleInput& input) {
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  return result.frame_cycles.empty() ? 0 : result.frame_cycles.front();
}

class PlainCycleLoopWindow : public testing::TestWithParam<std::pair<int, std::uint64_t>> {};

TEST_P(PlainCycleLoopWindow, TakesTheWorkedCyclesWithoutFilter) {
  PlainCycleInput input = paper_board();
  input.window = GetParam().first;
  EXPECT_EQ(first_frame_cycles(input), GetParam().second);
}

INSTANTIATE_TEST_SUITE_P(Contract, PlainCycleLoopWindow,
                         testing::Values(std::pair(5, 1'536'426), std::pair(7, 2'150'995),
                                         std::pair(9, 2'765'568), std::pair(11, 3'380'145),
                                         std::pair(13, 3'994'726), std::pair(15, 4'609'311)),
                         [](const auto& window) { return std::to_string(window.param.first); });

TEST(PlainCycleLoopWorkedValues, HoldForLineBuffer) {
  PlainCycleInput input = paper_board();
  input.fetch = PlainFetch::kLineBuffer;
  EXPECT_EQ(first_frame_cycles(input), 309'223U);
}

TEST(PlainCycleLoopWorkedValues, HoldWithLog7) {
  PlainCycleInput input = paper_board();
  input.filter_half = kLog7Half;
  EXPECT_EQ(first_frame_cycles(input), 2'151'016U);
  input.window = 5;
  EXPECT_EQ(first_frame_cycles(input), 1'539'641U);
  input.window = 7;
  input.fetch = PlainFetch::kLineBuffer;
  EXPECT_EQ(first_frame_cycles(input), 311'146U);
}

TEST(PlainCycleLoopWorkedValues, HoldWithATableInABankOfItsImage) {
  PlainCycleInput input = paper_board();
  input.left_lut = 0;
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  ASSERT_EQ(result.frame_cycles.size(), 1U);
  EXPECT_EQ(result.frame_cycles[0], 4'288'597U);
  EXPECT_EQ(result.blamed(PlainPort::kLeftLut, 0, PlainPort::kLeftPixel), 2'137'602U);
  EXPECT_EQ(result.blame.size(), 1U);
}

TEST(PlainCycleLoopWorkedValues, HoldWithTheResultInABankOfAnImage) {
  PlainCycleInput input = paper_board();
  input.disparity = {0, 0};
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  ASSERT_EQ(result.frame_cycles.size(), 1U);
  EXPECT_EQ(result.frame_cycles[0], 2'227'635U);
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, PlainPort::kResult), 76'640U);
  EXPECT_EQ(result.blame.size(), 1U);
}

TEST(PlainCycleLoopWorkedValues, HoldWithTheSameInSyncBurstBanks) {
  PlainCycleInput input = paper_board();
  input.disparity = {0, 0};
  for (PlainBank& bank : input.banks) bank = {PlainBankKind::kSyncBurst, 2};
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  ASSERT_EQ(result.frame_cycles.size(), 1U);
  EXPECT_EQ(result.frame_cycles[0], 2'534'153U);
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, std::nullopt), 306'518U);
  EXPECT_EQ(result.blamed(PlainPort::kResult, 0, std::nullopt), 152'960U);
}

TEST(PlainCycleLoopWorkedValues, HoldForThePortStatesOfTheTablePort) {
  const PlainCycleResult result = run_plain_cycle_loop(paper_board(), 1);
  const PlainPortStates& port = result.port(PlainPort::kLeftLut);
  EXPECT_EQ(port.granted, 2'142'720U);
  EXPECT_EQ(port.passed, 7'680U);
  EXPECT_EQ(port.idle, 579U);
  EXPECT_EQ(port.stalled + port.blocked + port.starved, 0U);
}

}  // namespace
}  // namespace stereotlm::test
