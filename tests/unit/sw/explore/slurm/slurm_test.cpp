#include "sw/explore/slurm/slurm.h"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

TEST(Slurm, ReadsTasksAndJobs) {
  const auto tasks = read_squeue("12|0|RUNNING|None\n12|7|PENDING|Resources\n13|N/A|PENDING|Dependency\n");
  ASSERT_EQ(tasks.size(), 3U);
  EXPECT_EQ(tasks[1].job, "12");
  EXPECT_EQ(tasks[1].index, 7U);
  EXPECT_EQ(tasks[1].state, "PENDING");
  EXPECT_EQ(tasks[1].reason, "Resources");
  EXPECT_EQ(tasks[2].index, std::nullopt);
  EXPECT_TRUE(read_squeue("").empty());
}

TEST(Slurm, RefusesAnotherFormat) {
  for (const char* text : {"12|0|RUNNING\n", "JOBID|N/A|RUNNING|None\n", "\n"})
    EXPECT_EQ(test::message_of([text] { read_squeue(text); }).find("squeue: unexpected output: "), 0U);
}

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
