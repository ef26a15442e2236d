#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/loop/core_loop.h"
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

TEST(SteppedText, SaysWhatIsSimulatedCycleByCycle) {
  const std::string pictures = "pictures in stripes or sdram, as their tables point to other pixels";
  const std::string rows = "rows of sdram that hold the end of one buffer and the start of another";
  const std::string captures = "accesses of captures and of the host in sdram";
  struct Case {
    const char* board;
    const char* image;
    bool camera;
    bool is_identity;
    std::string text;
  };
  // In sdram a picture of 160x64 is 40 rows of 64 words.
  const std::vector<Case> cases = {
      {"fpl2003", "{width: 160, height: 63}", true, false, ""},
      {"eight-banks-four-lanes", "{width: 32, height: 24}", true, true, ""},
      {"eight-banks-four-lanes", "{width: 32, height: 24}", true, false, pictures},
      {"sdram", "{width: 160, height: 64}", false, true, ""},
      {"sdram", "{width: 160, height: 64}", true, true, captures},
      {"sdram", "{width: 160, height: 64}", false, false, pictures},
      {"sdram", "{width: 160, height: 63}", false, true, rows},
      {"sdram", "{width: 160, height: 63}", true, true, captures + "; " + rows}};
  for (const auto& [name, image, camera, is_identity, text] : cases) {
    const auto board = platform::load_board(name, {std::string("image=") + image});
    platform::Tables tables = platform::identity_tables(board);
    if (!is_identity) tables.left->entries[0] = kernels::make_entry(1, 0);
    EXPECT_EQ(stepped_text(board, tables, camera), text) << name << ' ' << image;
  }
}

}  // namespace
}  // namespace stereotlm::runs
