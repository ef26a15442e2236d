#include "sw/explore/sweep/sweep_counts.h"

#include <gtest/gtest.h>

namespace stereotlm::explore {
namespace {

TEST(SweepCounts, AreReadBack) {
  const SweepCounts written = {21, 1, 2, 3, 4, 5, 6};
  const SweepCounts counts = read_counts(counts_text(written));
  EXPECT_EQ(counts_text(counts), counts_text(written));
  EXPECT_EQ(counts.total, 21U);
  EXPECT_EQ(counts.done(), 21U);
}

TEST(SweepCounts, OfNothingAreZero) {
  EXPECT_EQ(counts_text(read_counts("")), counts_text({}));
  EXPECT_EQ(read_counts("ok 3\nother 4\nfai").done(), 3U);
}

TEST(SweepCounts, AddUp) {
  SweepCounts sum = {21, 1, 2, 3, 4, 5, 6};
  sum.add({40, 10, 0, 20, 0, 1, 2});
  EXPECT_EQ(counts_text(sum), counts_text({61, 11, 2, 23, 4, 6, 8}));
}

}  // namespace
}  // namespace stereotlm::explore
