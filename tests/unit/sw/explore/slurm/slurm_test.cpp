#include "sw/explore/slurm/slurm.h"

#include <gtest/gtest.h>

namespace stereotlm::explore {
namespace {

TEST(Slurm, TaskIsLiveUntilItHasEnded) {
  for (const char* state : {"PENDING", "RUNNING", "COMPLETING", "CONFIGURING", "SUSPENDED", "REQUEUED"})
    EXPECT_TRUE((SlurmTask{"1", 0, state, ""}.is_live())) << state;
  for (const char* state : {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY"})
    EXPECT_FALSE((SlurmTask{"1", 0, state, ""}.is_live())) << state;
}

TEST(Slurm, ArrayNamesRanges) {
  EXPECT_EQ(array_text({0}), "0");
  EXPECT_EQ(array_text({0, 1, 2, 3}), "0-3");
  EXPECT_EQ(array_text({0, 3, 5, 6, 9}), "0,3,5-6,9");
}

}  // namespace
}  // namespace stereotlm::explore
