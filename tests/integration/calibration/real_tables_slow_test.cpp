// The core with the tables of the rig that took the chessboard pairs of opencv-doc: timing and blame as the
// plain cycle loop has them, pixels as the kernels have them on whole pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/grid.h"
#include "calib/rig.h"
#include "calib/rig_fit.h"
#include "calib/tables.h"
#include "models/kernels/stereo.h"
#include "platform/core_run.h"
#include "sw/media/load.h"
#include "tests/integration/core/preloaded_run.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"

namespace stereotlm::test {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kDisparities = 112;
constexpr int kWindow = 7;

kernels::GrayImage picture(const std::string& name) {
  return media::load_gray(std::string(STEREOTLM_PICTURES) + "/" + name).image;
}

calib::TablePair real_tables() {
  const calib::GridShape shape = {9, 6, 25};
  std::vector<calib::GridPair> pairs;
  for (const std::string number : {"01", "03", "05", "07", "09", "11", "13"}) {
    calib::GridPair pair = {*calib::find_grid(picture("left" + number + ".jpg"), shape).corners,
                            *calib::find_grid(picture("right" + number + ".jpg"), shape).corners};
    pair.right = calib::ordered_like(pair.left, shape, pair.right);
    pairs.push_back(pair);
  }
  const calib::Rig rig = calib::fit_rig(shape, kWidth, kHeight, pairs).rig;
  return calib::tables(rig, calib::rectify(rig), 97);
}

// The paper's board.
PlainCycleInput fpl2003(const calib::TablePair& tables) {
  PlainCycleInput input;
  input.width = kWidth;
  input.height = kHeight;
  input.window = kWindow;
  input.disparities = kDisparities;
  input.banks.resize(8);
  input.left_image = {0, 1};
  input.right_image = {2, 3};
  input.disparity = {4, 5};
  input.left_lut = 6;
  input.right_lut = 7;
  input.left_table = tables.left.entries;
  input.right_table = tables.right.entries;
  return input;
}

// Reads of a frame by columns: in each strip, of every row around it, each valid entry once.
std::uint64_t reads_of_valid_entries(const kernels::RectificationTable& table) {
  std::uint64_t reads = 0;
  for (int strip = 0; strip < kHeight; ++strip) {
    for (int row = std::max(0, strip - kWindow / 2); row <= std::min(kHeight - 1, strip + kWindow / 2);
         ++row) {
      const auto first = table.entries.begin() + static_cast<std::ptrdiff_t>(row) * kWidth;
      reads += static_cast<std::uint64_t>(kWidth - std::count(first, first + kWidth, 0U));
    }
  }
  return reads;
}

class RealTables : public testing::Test {
 protected:
  void expect_as_the_plain_loop(const PlainCycleInput& input) {
    const platform::BoardConfig board = board_config(input);
    const host::StereoPair pair = {picture("left01.jpg"), picture("right01.jpg")};
    const PreloadedRun run = run_preloaded(board, board_tables(input), {pair}, 1);
    EXPECT_EQ(differences(figures(run.statistics), figures(run_plain_cycle_loop(input, 1))), "");
    EXPECT_EQ(run.statistics.failed, std::vector<std::string>());
    EXPECT_LE(run.statistics.frames_per_second.core, run.statistics.bound.core);
    const platform::MatcherConfig& matcher = board.matcher;
    const kernels::GrayImage expected =
        kernels::disparity_image(pair.left, pair.right, &tables_.left, &tables_.right,
                                 {matcher.window, matcher.disparities, matcher.filter, matcher.lr_tolerance});
    EXPECT_TRUE(run.disparity.front() == expected);
    blame_ = run.statistics.blame.size();
    left_reads_ = run.statistics.ports[2].grants;
  }

  const calib::TablePair tables_ = real_tables();
  std::size_t blame_ = 0;  // rows
  std::uint64_t left_reads_ = 0;
};

TEST_F(RealTables, HoldInThePapersAllocation) {
  expect_as_the_plain_loop(fpl2003(tables_));
  EXPECT_EQ(blame_, 0U);
  const std::uint64_t all = reads_of_valid_entries(kernels::identity_table(kWidth, kHeight));
  EXPECT_EQ(left_reads_, reads_of_valid_entries(tables_.left));
  EXPECT_LT(left_reads_, all);
}

void put_into_two_banks(PlainCycleInput& input) {
  input.banks.resize(2);
  input.left_lut = input.right_lut = 0;
  input.left_image = input.right_image = input.disparity = {1};
  input.joint_tables = true;
  input.word_cache = true;
}

TEST_F(RealTables, HoldInTwoBanksWithJointTablesAndWordCache) {
  PlainCycleInput input = fpl2003(tables_);
  put_into_two_banks(input);
  expect_as_the_plain_loop(input);
  EXPECT_GT(blame_, 0U);
}

// The timing alone, frame after frame: the transitions of the first frame are followed again.
TEST_F(RealTables, HoldFrameAfterFrameInTwoBanks) {
  for (const PlainFetch fetch : {PlainFetch::kColumn, PlainFetch::kLineBuffer}) {
    PlainCycleInput input = fpl2003(tables_);
    input.fetch = fetch;
    input.filter_half = 3;
    put_into_two_banks(input);
    EXPECT_EQ(differences(figures(platform::run_core(board_config(input), board_tables(input), 3)),
                          figures(run_plain_cycle_loop(input, 3))),
              "");
  }
}

TEST_F(RealTables, GiveTheSameDisparitiesJointAndSeparate) {
  PlainCycleInput joint = fpl2003(tables_);
  put_into_two_banks(joint);
  const platform::BoardConfig boards[] = {board_config(fpl2003(tables_)), board_config(joint)};
  std::vector<host::StereoPair> pairs;
  for (const std::string number :
       {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"})
    pairs.push_back({picture("left" + number + ".jpg"), picture("right" + number + ".jpg")});
  std::vector<std::string> disparities;
  for (const platform::BoardConfig& board : boards) {
    disparities.push_back(run_for_text([&] {
      const PreloadedRun run =
          run_preloaded(board, board_tables(joint), pairs, pairs.size(), fpga::Fidelity::kFast);
      EXPECT_EQ(run.statistics.failed, std::vector<std::string>());
      std::string text;
      for (const kernels::GrayImage& image : run.disparity)
        text.append(image.pixels.begin(), image.pixels.end());
      return text;
    }));
  }
  EXPECT_GE(disparities[0].size(), pairs.size() * kWidth * kHeight);
  EXPECT_EQ(disparities[0], disparities[1]);
}

}  // namespace
}  // namespace stereotlm::test
