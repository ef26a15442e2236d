// The stages from columns of pixels to matches, each alone.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <vector>

#include "models/fpga/sad_array.h"
#include "models/fpga/select_min_chain.h"
#include "models/fpga/select_min_tree.h"
#include "models/kernels/lane_array.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

constexpr std::uint8_t kNone = 255;

void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }

// Keeps the sums themselves: they are only valid during the push.
class CollectedSums : public StreamIf<WindowSums> {
 public:
  struct Copy {
    std::vector<std::int32_t> sums;
    int candidates = 0;
    bool left_valid = false;
  };
  void push(const WindowSums& window) override {
    windows.push_back({{window.sums, window.sums + window.lanes}, window.candidates, window.left_valid});
  }
  std::vector<Copy> windows;
};

class SadArrayTest : public testing::Test {
 protected:
  static constexpr int kWidth = 12;
  static constexpr int kHeight = 5;
  static constexpr int kWindow = 3;
  static constexpr int kDisparities = 4;

  SadArrayTest() {
    config.width = kWidth;
    config.height = kHeight;
    config.window = kWindow;
    config.disparities = kDisparities;
    config.filter.reset();
  }

  // Row outside the image: whatever the lane hands over, here 77.
  static std::uint8_t at(const std::vector<std::uint8_t>& image, int column, int row) {
    if (row < 0 || row >= kHeight) return 77;
    return image[static_cast<std::size_t>(row * kWidth + column)];
  }
  static bool valid(int column, int row) { return (2 * column + row) % 5 != 0; }

  PixelColumn column_of(const std::vector<std::uint8_t>& image, int column, int strip) const {
    PixelColumn out;
    for (int k = 0; k < kWindow; ++k) {
      const int row = strip - 1 + k;
      out.values[static_cast<std::size_t>(k)] = at(image, column, row);
      if (row >= 0 && row < kHeight && valid(column, row)) out.valid |= 1U << k;
    }
    return out;
  }
  int sad(int x, int y, int d) const {
    int sum = 0;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) sum += std::abs(at(right, x - d + i, y + j) - at(left, x + i, y + j));
    }
    return sum;
  }

  CoreConfig config;
  std::vector<std::uint8_t> left = noise(kWidth * kHeight, 1);
  std::vector<std::uint8_t> right = noise(kWidth * kHeight, 2);
};

TEST_F(SadArrayTest, SumsTheWindowOfEveryCandidateAtEveryLeftPixel) {
  SadArray array("sad_array", config);
  CollectedSums chain;
  CollectedSums tree;
  array.chain_out.bind(chain);
  array.tree_out.bind(tree);
  elaborate();
  std::uint64_t candidates = 0;
  for (int frame = 0; frame < 2; ++frame) {
    chain.windows.clear();
    tree.windows.clear();
    array.start_frame();
    for (int strip = 0; strip < kHeight; ++strip) {
      for (int column = 0; column < kWidth; ++column) {
        // Either side may come first.
        if (column % 2 == 0) array.left_in->push(column_of(left, column, strip));
        array.right_in->push(column_of(right, column, strip));
        if (column % 2 != 0) array.left_in->push(column_of(left, column, strip));
      }
    }
    // The first window is complete with the column after its middle.
    ASSERT_EQ(tree.windows.size(), static_cast<std::size_t>(kWidth * kHeight - 1));
    ASSERT_EQ(chain.windows.size(), tree.windows.size());
    for (int pixel = 0; pixel < kWidth * kHeight - 1; ++pixel) {
      const CollectedSums::Copy& window = tree.windows[static_cast<std::size_t>(pixel)];
      const int x = pixel % kWidth;
      const int y = pixel / kWidth;
      const bool inside = x >= 1 && x < kWidth - 1 && y >= 1 && y < kHeight - 1;
      ASSERT_EQ(window.candidates, inside ? std::min(kDisparities, x) : 0) << x << ' ' << y;
      for (int d = 0; d < window.candidates; ++d)
        EXPECT_EQ(window.sums[static_cast<std::size_t>(d)], sad(x, y, d)) << x << ' ' << y << ' ' << d;
      EXPECT_EQ(window.left_valid, valid(x, y)) << x << ' ' << y;
      EXPECT_EQ(chain.windows[static_cast<std::size_t>(pixel)].sums, window.sums);
      candidates += static_cast<std::uint64_t>(window.candidates);
    }
  }
  EXPECT_EQ(array.stats().columns, 2U * kWidth * kHeight);
  EXPECT_EQ(array.stats().absolute_differences, array.stats().columns * kWindow * kDisparities);
  EXPECT_EQ(array.stats().candidates, candidates);
}

TEST_F(SadArrayTest, WaitsForTheFilterAndTheRowsAbove) {
  // With a 5 x 5 filter (h = 2) the window's column is h columns older, and one more strip comes first.
  config.filter = kernels::FilterKernel{5, std::vector<int>(25), 0};
  SadArray array("sad_array", config);
  CollectedSums chain;
  CollectedSums tree;
  array.chain_out.bind(chain);
  array.tree_out.bind(tree);
  elaborate();
  array.start_frame();
  for (int column = 0; column < 3 * kWidth; ++column) {
    array.left_in->push({});
    EXPECT_EQ(tree.windows.size(), static_cast<std::size_t>(std::max(0, column - (2 + 1))));
    array.right_in->push({});
    EXPECT_EQ(tree.windows.size(), static_cast<std::size_t>(std::max(0, column + 1 - (2 + 1))));
  }
  // The first windows that lie inside are those of row 1, in the third strip.
  int first = 0;
  while (tree.windows[static_cast<std::size_t>(first)].candidates == 0) ++first;
  EXPECT_EQ(first, 2 * kWidth + 1);
}

// Sums for the first lanes; the others hold what must not matter.
class Sums {
 public:
  explicit Sums(std::vector<std::int32_t> values) : values_(std::move(values)) {
    window_.candidates = static_cast<int>(values_.size());
    values_.resize(kernels::kLanePadding, 0);
    std::copy(values_.begin(), values_.end(), lanes_.data());
    window_.sums = lanes_.data();
    window_.lanes = kernels::kLanePadding;
  }
  Sums(const Sums&) = delete;
  WindowSums& window() { return window_; }

 private:
  std::vector<std::int32_t> values_;
  kernels::LaneArray<std::int32_t> lanes_{kernels::kLanePadding};
  WindowSums window_;
};

TEST(SelectMinTree, FindsTheSmallestSumOfAColumn) {
  SelectMinTree tree("tree");
  Collected<LeftMatch> matches;
  tree.matches_out.bind(matches);
  elaborate();
  const auto match = [&](std::vector<std::int32_t> values, bool valid) {
    Sums sums(std::move(values));
    sums.window().left_valid = valid;
    tree.sums_in->push(sums.window());
    EXPECT_EQ(matches.beats.back().left_valid, valid);
    return int{matches.beats.back().disparity};
  };
  EXPECT_EQ(match({5, 3, 9}, true), 1);
  EXPECT_EQ(match({5, 3, 3, 4}, false), 1);  // the smallest disparity wins a tie
  EXPECT_EQ(match({31 * 31 * 255}, true), 0);
  EXPECT_EQ(match({}, true), int{kNone});
  EXPECT_EQ(tree.stats().columns, 4U);
  EXPECT_EQ(tree.stats().matches, 3U);
}

TEST(SelectMinChain, FindsTheSmallestSumOfEachRightPixel) {
  constexpr int kDisparities = 3;
  SelectMinChain chain("chain", kDisparities);
  Collected<RightMatch> matches;
  chain.matches_out.bind(matches);
  elaborate();
  // Column x holds the sums of right pixels x, x-1 and x-2 for candidates 0, 1 and 2.
  const std::vector<std::vector<std::int32_t>> columns = {{9},       {4, 7}, {6, 4, 7}, {1, 5, 4},
                                                          {2, 2, 2}, {},     {}};
  const std::vector<std::uint8_t> of_right_pixel = {1, 0, 2, 0, 0, kNone, kNone};
  for (int frame = 0; frame < 2; ++frame) {
    matches.beats.clear();
    chain.start_frame();
    for (const auto& column : columns) {
      Sums sums(column);
      chain.sums_in->push(sums.window());
    }
    ASSERT_EQ(matches.beats.size(), columns.size());
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const std::uint8_t expected =
          column < kDisparities - 1 ? kNone : of_right_pixel[column - (kDisparities - 1)];
      EXPECT_EQ(matches.beats[column].disparity, expected) << column;
    }
  }
  EXPECT_EQ(chain.stats().columns, 14U);
  EXPECT_EQ(chain.stats().matches, 10U);
}

}  // namespace
}  // namespace stereotlm::fpga
