#include "models/kernels/vector_loops.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "models/kernels/sad_columns.h"
#include "models/kernels/select_min.h"
#include "models/kernels/words.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::SplitMix64;

// Runs `check` once with each instruction set that the loops are compiled for and this machine has.
void with_each_instruction_set(const std::function<void()>& check) {
  const auto choose = [](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  int targets = 0;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    choose(target);
    check();
    ++targets;
  }
  choose(0);
  EXPECT_GE(targets, 1);
}

// Both matches of one pair of filtered images, by the kernels of the FPGA's stages, one window row after the
// other.
struct Streamed {
  std::vector<int> right_based;  // -1 where invalid
  std::vector<int> left_based;
};

Streamed streamed_matches(const test::RandomBoard& board, const std::vector<std::uint8_t>& left,
                          const std::vector<std::uint8_t>& right) {
  const int width = board.width;
  const int radius = (board.window - 1) / 2;
  Streamed matches{std::vector<int>(left.size(), -1), std::vector<int>(left.size(), -1)};
  const auto place = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  };
  const auto signed_of = [](std::uint8_t d) { return d == kInvalidDisparity ? -1 : int{d}; };
  SadColumns sums(board.window, board.disparities);
  SelectMinChain chain(board.disparities);
  std::array<std::uint8_t, 31> left_pixels{};
  std::array<std::uint8_t, 31> right_pixels{};
  for (int row = radius; row < board.height - radius; ++row) {
    sums.start_frame();
    chain.start_frame();
    // `column` ends the window around left pixel column - radius; unit A runs on until its last pixel has
    // left it.
    for (int column = 0; column < width + radius + board.disparities - 1; ++column) {
      for (int k = 0; k < board.window && column < width; ++k) {
        left_pixels[static_cast<std::size_t>(k)] = left[place(column, row - radius + k)];
        right_pixels[static_cast<std::size_t>(k)] = right[place(column, row - radius + k)];
      }
      sums.push_column(left_pixels.data(), right_pixels.data());
      const int centre = column - radius;
      if (centre < 0) continue;
      const int candidates =
          candidate_count(centre, row, width, board.height, board.window, board.disparities);
      if (centre < width) {
        matches.left_based[place(centre, row)] =
            signed_of(select_min_tree(sums.window_sums(), candidates, sums.lanes()));
      }
      const int right_based = signed_of(chain.step(sums.window_sums(), candidates));
      const int right_column = centre - (board.disparities - 1);
      if (right_column >= 0 && right_column < width)
        matches.right_based[place(right_column, row)] = right_based;
    }
  }
  return matches;
}

TEST(VectorLoops, GiveTheReferencesMatchesWithEachInstructionSet) {
  for (std::uint64_t seed = 5000; seed < 5080; ++seed) {
    const test::RandomBoard board = test::make_random_board(seed);
    SCOPED_TRACE(describe(board));
    const auto expected = test::compute_reference(test::reference_input(board, 0));
    with_each_instruction_set([&] {
      const Streamed found = streamed_matches(board, expected.filtered_left, expected.filtered_right);
      EXPECT_EQ(found.right_based, expected.right_based);
      EXPECT_EQ(found.left_based, expected.left_based);
    });
  }
}

TEST(VectorLoops, StepAllWindows) {
  SplitMix64 random(1);
  for (const int rows : {1, 3, 31}) {
    for (const int lanes : {16, 32, 80, 256}) {
      std::vector<std::vector<std::uint8_t>> histories(static_cast<std::size_t>(rows));
      std::vector<const std::uint8_t*> newest;
      std::vector<std::uint8_t> left;
      for (auto& history : histories) {
        for (int d = 0; d < lanes; ++d) history.push_back(static_cast<std::uint8_t>(random.between(0, 255)));
        history[5] = 255;
        newest.push_back(history.data());
        left.push_back(static_cast<std::uint8_t>(random.chance(50) ? 0 : random.between(0, 255)));
      }
      LaneArray<std::int16_t> leaving(lanes);
      LaneArray<std::int32_t> windows(lanes);
      for (int d = 0; d < lanes; ++d) {
        leaving.data()[d] = static_cast<std::int16_t>(random.between(0, 31 * 255));
        windows.data()[d] = leaving.data()[d] + random.between(0, 30 * 31 * 255);
      }
      with_each_instruction_set([&] {
        LaneArray<std::int16_t> leaving_now = leaving;
        LaneArray<std::int32_t> windows_now = windows;
        step_windows(newest.data(), left.data(), rows, lanes, leaving_now.data(), windows_now.data());
        for (int d = 0; d < lanes; ++d) {
          int sum = 0;
          for (std::size_t row = 0; row < left.size(); ++row)
            sum += std::abs(histories[row][static_cast<std::size_t>(d)] - left[row]);
          ASSERT_EQ(leaving_now.data()[d], sum) << d;
          ASSERT_EQ(windows_now.data()[d], windows.data()[d] + sum - leaving.data()[d]) << d;
        }
      });
    }
  }
}

// Sums of one column with ties in half of the rounds.
LaneArray<std::int32_t> random_sums(int lanes, SplitMix64& random) {
  LaneArray<std::int32_t> sums(lanes);
  const int largest = random.chance(50) ? 3 : 31 * 31 * 255;
  for (int d = 0; d < lanes; ++d) sums.data()[d] = random.between(0, largest);
  return sums;
}

std::int32_t key(const LaneArray<std::int32_t>& sums, int d, int candidates) {
  return d < candidates ? sums.data()[d] * 256 + d : std::numeric_limits<std::int32_t>::max();
}

TEST(VectorLoops, StepTheChainAndFindTheSmallestKey) {
  SplitMix64 random(2);
  for (int round = 0; round < 300; ++round) {
    const int lanes = 32 * random.between(1, 8);
    const int candidates = random.between(0, std::min(lanes, 254));
    const auto sums = random_sums(lanes, random);
    LaneArray<std::int32_t> held(lanes + kLanePadding);
    for (int d = 0; d < lanes + kLanePadding; ++d)
      held.data()[d] = random.chance(20) ? std::numeric_limits<std::int32_t>::max()
                                         : random.between(0, 31 * 31 * 255 * 256 + 253);
    std::int32_t smallest = std::numeric_limits<std::int32_t>::max();
    for (int d = 0; d < lanes; ++d) smallest = std::min(smallest, key(sums, d, candidates));
    with_each_instruction_set([&] {
      LaneArray<std::int32_t> next(lanes + kLanePadding);
      step_chain(sums.data(), candidates, lanes, held.data() + kLanePadding, next.data() + kLanePadding);
      for (int d = 0; d < lanes; ++d) {
        ASSERT_EQ(next.data()[kLanePadding + d],
                  std::min(held.data()[kLanePadding + d - 1], key(sums, d, candidates)))
            << d;
      }
      ASSERT_EQ(smallest_key(sums.data(), candidates, lanes), smallest);
    });
  }
}

// Weights of both signs whose sums over pixels of 0..255 just stay within 2^24.
std::vector<float> weights_within_24_bits(int size, SplitMix64& random) {
  const int count = size * size;
  const int most = (1 << 24) / 255 / (count / 2 + 1);
  std::vector<float> weights;
  for (int place = 0; place < count; ++place)
    weights.push_back(
        static_cast<float>(random.chance(50) ? random.between(0, most) : -random.between(0, most)));
  return weights;
}

TEST(VectorLoops, FilterOneColumn) {
  SplitMix64 random(3);
  for (const int size : {3, 5, 7, 9, 15, 31}) {
    for (const int rows : {1, 3, 7, 8, 9, 16, 17, 31, 32}) {
      for (const int shift : {0, 6, 13, 16, 31}) {
        SCOPED_TRACE("size " + std::to_string(size) + ", rows " + std::to_string(rows) + ", shift " +
                     std::to_string(shift));
        const int stride = padded_rows(rows) + size - 1 + random.between(0, 3);
        std::vector<float> columns(static_cast<std::size_t>(size * stride));
        for (float& pixel : columns)
          pixel = static_cast<float>(random.chance(40) ? 255 * random.between(0, 1) : random.between(0, 255));
        const auto weights = weights_within_24_bits(size, random);
        with_each_instruction_set([&] {
          std::array<std::uint8_t, 33> out{};
          out.fill(0xA5);
          filter_column(columns.data(), stride, weights.data(), size, rows, shift, out.data());
          for (int k = 0; k < rows; ++k) {
            std::int64_t sum = 0;
            for (int i = 0; i < size; ++i) {
              for (int j = 0; j < size; ++j) {
                sum += static_cast<std::int64_t>(weights[static_cast<std::size_t>(i * size + j)]) *
                       static_cast<std::int64_t>(columns[static_cast<std::size_t>(i * stride + k + j)]);
              }
            }
            const std::int64_t level = 128 + (sum >> shift);
            ASSERT_EQ(out[static_cast<std::size_t>(k)], std::clamp<std::int64_t>(level, 0, 255)) << k;
          }
          ASSERT_EQ(out[static_cast<std::size_t>(padded_rows(rows))], 0xA5);
        });
      }
    }
  }
}

TEST(LaneArray, IsPaddedAlignedAndZero) {
  for (const auto& [lanes, padded] :
       {std::pair(1, 16), std::pair(16, 16), std::pair(17, 32), std::pair(254, 256)}) {
    EXPECT_EQ(padded_lanes(lanes), padded);
    LaneArray<std::int16_t> array(lanes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % kLaneAlignment, 0U);
    for (int lane = 0; lane < padded; ++lane) EXPECT_EQ(array.data()[lane], 0);
  }
}

}  // namespace
}  // namespace stereotlm::kernels
