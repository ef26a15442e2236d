#include "models/kernels/select_min.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "models/kernels/lr_check.h"
#include "models/kernels/words.h"
#include "tests/support/random_board.h"

namespace stereotlm::kernels {
namespace {

constexpr int kLargestSum = 31 * 31 * 255;

// Window sums of one column. Those beyond the candidates are smaller than all others.
SimdArray<std::int32_t> random_sums(int disparities, int candidates, int largest, test::SplitMix64& random) {
  SimdArray<std::int32_t> sums(disparities);
  sums.fill(0);
  for (int d = 0; d < candidates; ++d) sums.data()[d] = random.between(1, largest);
  return sums;
}

TEST(SelectMinTree, EqualsALoopWithEachInstructionSet) {
  test::SplitMix64 random(11);
  for (int round = 0; round < 2000; ++round) {
    const int disparities = random.between(1, 254);
    const int candidates = random.between(0, disparities);
    const auto sums = random_sums(disparities, candidates, random.chance(50) ? 4 : kLargestSum, random);
    const int* first = sums.data();
    for (const Simd* simd : simd_sets())
      ASSERT_EQ(select_min_tree(first, candidates, padded_lanes(disparities), *simd),
                candidates == 0 ? kInvalidDisparity : std::min_element(first, first + candidates) - first)
          << simd->name;
  }
}

TEST(SelectMinChain, EqualsALoopOverTheDiagonalWithEachInstructionSet) {
  test::SplitMix64 random(12);
  for (const int disparities : {1, 2, 31, 32, 33, 80, 254}) {
    std::vector<SelectMinChain> chains;
    for (const Simd* simd : simd_sets()) chains.emplace_back(disparities, *simd);
    for (const int largest : {1, 4, kLargestSum}) {
      SCOPED_TRACE(std::to_string(disparities) + " disparities, sums up to " + std::to_string(largest));
      std::vector<SimdArray<std::int32_t>> columns;
      std::vector<int> candidates;
      for (SelectMinChain& chain : chains) chain.start_frame();
      for (int column = 0; column < 3 * disparities + 20; ++column) {
        candidates.push_back(random.chance(20) ? 0 : random.between(0, disparities));
        columns.push_back(random_sums(disparities, candidates.back(), largest, random));
        // Candidate d of the right pixel D-1 columns back is the left pixel d columns after it.
        int expected = kInvalidDisparity;
        int smallest = 0;
        for (int d = 0; d < disparities; ++d) {
          const int at = column - (disparities - 1) + d;
          if (at < 0 || d >= candidates[static_cast<std::size_t>(at)]) continue;
          const int sum = columns[static_cast<std::size_t>(at)].data()[d];
          if (expected == kInvalidDisparity || sum < smallest) {
            expected = d;
            smallest = sum;
          }
        }
        for (std::size_t set = 0; set < chains.size(); ++set)
          ASSERT_EQ(int{chains[set].step(columns.back().data(), candidates.back())}, expected)
              << simd_sets()[set]->name << ' ' << column;
      }
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels
