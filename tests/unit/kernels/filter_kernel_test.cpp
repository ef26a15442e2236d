#include "models/kernels/filter_kernel.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::kernels {
namespace {

using Problems = std::vector<std::string>;

FilterKernel zeros(int size) {
  return {size, std::vector<int>(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)), 0};
}

TEST(FilterKernel, Log7HasTheWeightsOfTheContract) {
  const int quarter[4][4] = {{0, -1, -3, -5}, {-1, -6, -14, -16}, {-3, -14, 0, 35}, {-5, -16, 35, 112}};
  const FilterKernel kernel = log7();
  EXPECT_EQ(kernel.size, 7);
  EXPECT_EQ(kernel.half(), 3);
  EXPECT_EQ(kernel.shift, 6);
  EXPECT_EQ(kernel.weights.size(), 49U);
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 7; ++column)
      EXPECT_EQ(kernel.weight(column, row), quarter[3 - std::abs(row - 3)][3 - std::abs(column - 3)]);
  }
  EXPECT_EQ(problems(kernel), Problems());
}

TEST(FilterKernel, ListsItsWeightsRowByRow) {
  const FilterKernel kernel{3, {1, 2, 3, 4, 5, 6, 7, 8, -36}, 0};
  EXPECT_EQ(kernel.weight(2, 0), 3);
  EXPECT_EQ(kernel.weight(0, 2), 7);
}

TEST(FilterKernel, MayReachTheEndsOfItsRanges) {
  for (const int size : {3, 5, 29, 31}) EXPECT_EQ(problems(zeros(size)), Problems()) << size;
  for (const int shift : {0, 31})
    EXPECT_EQ(problems({3, {32767, -32768, 1, 0, 0, 0, 0, 0, 0}, shift}), Problems());
}

TEST(FilterKernel, NamesTheRuleThatItBreaks) {
  const std::vector<std::pair<FilterKernel, std::string>> broken = {
      {{3, std::vector<int>(10), 0}, "kernel entries = 10: must be 3 rows of 3"},
      {{3, std::vector<int>(8), 0}, "kernel entries = 8: must be 3 rows of 3"},
      {{3, {32768, -32768, 0, 0, 0, 0, 0, 0, 0}, 0}, "kernel entry = 32768: must be -32768..32767"},
      {{3, {32767, -32769, 2, 0, 0, 0, 0, 0, 0}, 0}, "kernel entry = -32769: must be -32768..32767"},
      {{3, {1, 1, 1, 1, -8, 1, 1, 1, 2}, 0}, "kernel sum = 1: must be 0"},
      {{3, {1, 1, 1, 1, -8, 1, 1, 1, 0}, 0}, "kernel sum = -1: must be 0"},
      {{3, std::vector<int>(9), -1}, "shift = -1: must be 0..31"},
      {{3, std::vector<int>(9), 32}, "shift = 32: must be 0..31"},
  };
  for (const auto& [kernel, problem] : broken) EXPECT_EQ(problems(kernel), Problems{problem});
  for (const int size : {0, 1, 2, 4, 30, 32, 33}) {
    EXPECT_EQ(problems(zeros(size)),
              Problems{"kernel size = " + std::to_string(size) + ": must be 3..31, odd"});
  }
  EXPECT_EQ(problems({2, {40000, 1, 1}, 32}).size(), 5U);
}

}  // namespace
}  // namespace stereotlm::kernels
