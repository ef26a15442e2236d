// The bounds that rule out placements, beside runs of random boards: no frame is below them.
#include "platform/figures/search_bounds.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/loop/core_loop.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/random_board.h"

namespace stereotlm::test {
namespace {

using platform::BoardConfig;

std::string bounds_that_are_wrong(std::uint64_t seed, bool with_knobs) {
  const RandomBoard board =
      make_random_board(seed, with_knobs ? RandomKnobs::with_section_8() : RandomKnobs{});
  const BoardConfig config = board_config(board);
  const platform::Tables tables = board_tables(board);
  const platform::FrameAccesses accesses = platform::frame_accesses(config, tables);
  const auto frames = static_cast<std::uint64_t>(board.frames);
  const std::vector<std::uint64_t> cycles = platform::run_core(config, tables, frames).frame_cycles;
  const std::vector<std::uint64_t> waitless = platform::waitless_frame_cycles(config, tables, frames);
  std::string text;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const std::uint64_t least = platform::least_frame_cycles(config, accesses, frame);
    std::uint64_t most = 0;
    for (const auto& bound : frame_bounds(config, accesses, frame)) most = std::max(most, bound.cycles);
    if (least > cycles.at(frame) || waitless.at(frame) > cycles[frame] || least < most)
      text += fmt::format("seed {}, frame {}: {} cycles, least {}, waitless {}, bound of a resource {}\n",
                          seed, frame, cycles[frame], least, waitless[frame], most);
  }
  return text;
}

// With STEREOTLM_RANDOM_BOARDS that many boards of each kind.
TEST(SearchBounds, AreNotAboveTheFramesOfRandomBoards) {
  constexpr std::uint64_t kBoardsOfAJob = 50;
  const std::uint64_t boards = random_boards(400);
  std::vector<ChildWork> jobs;
  for (const bool with_knobs : {false, true}) {
    for (std::uint64_t first = 0; first < boards; first += kBoardsOfAJob) {
      jobs.push_back([=] {
        std::string text;
        for (std::uint64_t seed = first; seed < std::min(first + kBoardsOfAJob, boards); ++seed)
          text += bounds_that_are_wrong(seed, with_knobs);
        return text;
      });
    }
  }
  // Lanes that share the openings of a row, each in another strip.
  jobs.push_back([] { return bounds_that_are_wrong(20'758, true); });
  const auto processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (const ChildResult& result : run_in_children(jobs, processors, std::chrono::seconds(200)))
    EXPECT_TRUE(result.ok()) << result.text;
}

TEST(SearchBounds, CountTheAccessesOfIdentityTablesWithoutTables) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const RandomBoard random = make_random_board(seed, RandomKnobs::with_section_8());
    const BoardConfig board = board_config(random);
    SCOPED_TRACE(describe(random));
    const platform::FrameAccesses found = platform::identity_accesses(board);
    const platform::FrameAccesses expected =
        platform::frame_accesses(board, platform::identity_tables(board));
    EXPECT_EQ(found.reads, expected.reads);
    EXPECT_EQ(found.reads_of_row, expected.reads_of_row);
    EXPECT_EQ(found.touched, expected.touched);
    EXPECT_EQ(found.pixels_of_row, expected.pixels_of_row);
  }
}

// How far one frame of a board may be above its bound, in millionths: most of what the bound counts.
struct Close {
  const char* what;
  std::vector<std::string> keys;
  std::uint64_t millionths;
};
void PrintTo(const Close& close, std::ostream* out) { *out << close.what; }

class CloseBounds : public testing::TestWithParam<Close> {};

Close close(const char* what, const std::string& allocation, std::uint64_t millionths,
            const std::vector<std::string>& more = {}) {
  std::vector<std::string> keys = {"allocation={" + allocation + "}"};
  keys.insert(keys.end(), more.begin(), more.end());
  return {what, keys, millionths};
}

const std::string kResultsBesidePictures =
    "left_image: bank0, right_image: bank1, disparity: bank0, left_lut: bank2, right_lut: bank3";
const std::string kAllInOne =
    "left_image: bank0, right_image: bank0, disparity: bank0, left_lut: bank0, right_lut: bank0";
const std::string kSdram =
    "ssram.default={words: 4194304, kind: sdram, cas_latency: 2, row_words: 256, internal_banks: 4, "
    "activate_cycles: 1, precharge_cycles: 1, refresh_interval_cycles: 625, refresh_cycles: 3}";
const std::string kSyncBurst = "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}";

INSTANTIATE_TEST_SUITE_P(
    Shared, CloseBounds,
    testing::Values(
        close("EdgesOfTheImage", kResultsBesidePictures, 1500), close("AllInOneBank", kAllInOne, 1500),
        close("Turnaround", kResultsBesidePictures, 5500, {kSyncBurst}),
        close("TurnaroundOfAll", kAllInOne, 1500, {kSyncBurst}),
        close("TurnaroundByTurns", kAllInOne, 1000, {kSyncBurst, "fpga.arbitration=round_robin"}),
        close("RowsOfPictures", kResultsBesidePictures, 12000, {kSdram}),
        close("StripesInTurn",
              "left_image: {rows: [bank0, bank1]}, right_image: {rows: [bank2, bank3]}, disparity: bank4, "
              "left_lut: {rows: [bank5, bank6]}, right_lut: {rows: [bank7, bank8]}",
              50000,
              {"fpga.lanes=4",
               "ssram.banks={bank0: {}, bank1: {}, bank2: {}, bank3: {}, bank4: {}, bank5: {}, bank6: {}, "
               "bank7: {}, bank8: {}}"})),
    [](const auto& suite) { return suite.param.what; });

TEST_P(CloseBounds, AreReached) {
  std::vector<std::string> sets = {"image={width: 320, height: 120}"};
  sets.insert(sets.end(), GetParam().keys.begin(), GetParam().keys.end());
  const BoardConfig board = platform::load_board("fpl2003", sets);
  const auto cycles = platform::run_core(board, platform::identity_tables(board), 1).frame_cycles.front();
  const std::uint64_t least = platform::least_frame_cycles(board, platform::identity_accesses(board), 0);
  EXPECT_LE(least, cycles);
  EXPECT_GE(least * (1'000'000 + GetParam().millionths), cycles * 1'000'000) << least << " of " << cycles;
}

}  // namespace
}  // namespace stereotlm::test
