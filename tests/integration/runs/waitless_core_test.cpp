#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/preloaded_system.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::runs {
namespace {

double rate_of(const platform::BoardConfig& board, std::uint64_t frames) {
  return platform::run_core(board, platform::identity_tables(board), frames).frames_per_second.core;
}

double waitless_rate_of(const platform::BoardConfig& board, std::uint64_t frames) {
  return waitless_frames_per_second(board, platform::identity_tables(board), frames);
}

TEST(WaitlessCore, RunsAsIfEachBufferHadABankOfItsOwn) {
  const double uncontended = rate_of(platform::load_board("fpl2003"), 1);
  const std::vector<std::vector<std::string>> shared = {
      {"allocation.left_lut=bank0"},
      {"allocation={left_image: bank0, right_image: bank0, disparity: bank0, left_lut: bank1, right_lut: "
       "bank2}"}};
  for (const auto& sets : shared) {
    const platform::BoardConfig board = platform::load_board("fpl2003", sets);
    EXPECT_LT(rate_of(board, 2), uncontended);
    EXPECT_DOUBLE_EQ(waitless_rate_of(board, 2), uncontended);
  }
  // A column of 7 slots takes 2 cycles.
  const platform::BoardConfig lanes = platform::load_board("fpl2003", {"fpga.lanes=4"});
  EXPECT_NEAR(waitless_rate_of(lanes, 1), 3.5 * uncontended, 0.01 * uncontended);
}

TEST(WaitlessCore, CountsFramesOfAnUnfinishedTurnOfTheLists) {
  const platform::BoardConfig board = platform::load_board(
      "fpl2003-triple", {"image={width: 64, height: 48}",
                         "ssram.banks={a: {kind: zbt_flow_through}, b: {}, c: {}, d: {kind: "
                         "zbt_flow_through}, e: {}, f: {}, g: {}, "
                         "h: {}, i: {}}",
                         "allocation={left_image: [a, b, c], right_image: [d, e, f], disparity: g, left_lut: "
                         "h, right_lut: i}"});
  ASSERT_NE(rate_of(board, 1), rate_of(board, 2)) << "the frames differ";
  for (const std::uint64_t frames : {1U, 2U, 3U, 4U, 5U})
    EXPECT_DOUBLE_EQ(waitless_rate_of(board, frames), rate_of(board, frames)) << frames;
}

}  // namespace
}  // namespace stereotlm::runs
