// The random boards compare the disparities, but not those of the columns before the first candidates.
#include "models/kernels/select_min.h"

#include <gtest/gtest.h>

namespace stereotlm::kernels {
namespace {

TEST(SelectMin, ChainsForgetTheLastFrame) {
  constexpr std::int64_t kScores[] = {2, 1};
  const ColumnScores scores{kScores, kScores, 1};
  SimdArray<std::int32_t> sums(2);
  sums.fill(1);
  SelectMinChain sum_chain(2);
  ScoreChain score_chain(2);
  sum_chain.step(sums.data(), 2);
  score_chain.step(scores, 2);
  sum_chain.start_frame();
  score_chain.start_frame();
  EXPECT_EQ(sum_chain.step(sums.data(), 0), kInvalidDisparity);
  EXPECT_EQ(score_chain.step(scores, 0), kInvalidDisparity);
}

}  // namespace
}  // namespace stereotlm::kernels
