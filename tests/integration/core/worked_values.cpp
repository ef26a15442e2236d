#include "tests/integration/core/worked_values.h"

#include <gtest/gtest.h>

#include <utility>

#include "models/kernels/stereo.h"
#include "platform/config/board_yaml.h"
#include "tests/integration/core/preloaded_run.h"
#include "tests/support/random_board.h"

namespace stereotlm::test {
namespace {

// Two views of one scene of noise, 37 pixels apart.
host::StereoPair noise_pair(int width, int height) {
  constexpr int kDisparity = 37;
  SplitMix64 random(640);
  host::StereoPair pair{kernels::GrayImage(width, height), kernels::GrayImage(width, height)};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width + kDisparity; ++column) {
      const auto pixel = static_cast<std::uint8_t>(random.between(0, 255));
      if (column < width) pair.left.at(column, row) = pixel;
      if (column >= kDisparity) pair.right.at(column - kDisparity, row) = pixel;
    }
  }
  return pair;
}

std::vector<std::string> blame_of(const platform::Statistics& statistics) {
  std::vector<std::string> rows;
  for (const platform::BlameRow& row : statistics.blame)
    rows.push_back(row.port + " in " + row.bank + " by " + row.by + ": " + std::to_string(row.cycles));
  return rows;
}

}  // namespace

platform::Statistics expect_worked_values(const WorkedFrame& frame) {
  const platform::BoardConfig board = platform::load_board(frame.preset, frame.sets);
  const platform::Tables tables = platform::identity_tables(board);
  const host::StereoPair pair = noise_pair(board.image.width, board.image.height);
  PreloadedRun run = run_preloaded(board, tables, {pair}, 1);
  EXPECT_EQ(run.statistics.frame_cycles, std::vector<std::uint64_t>{frame.frame_cycles});
  EXPECT_EQ(blame_of(run.statistics), frame.blame);
  EXPECT_EQ(run.statistics.failed, std::vector<std::string>());
  EXPECT_LE(run.statistics.frames_per_second.core, run.statistics.bound.core);
  const platform::MatcherConfig& matcher = board.matcher;
  const kernels::GrayImage expected =
      kernels::disparity_image(pair.left, pair.right, nullptr, nullptr,
                               {matcher.window, matcher.disparities, matcher.filter, matcher.lr_tolerance});
  EXPECT_TRUE(run.disparity.size() == 1 && run.disparity.front() == expected);
  return std::move(run.statistics);
}

}  // namespace stereotlm::test
