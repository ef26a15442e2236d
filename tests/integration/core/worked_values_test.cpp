#include "tests/integration/core/worked_values.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

// Worked values at the end of contract section 2, through all modules, on the presets and with `--set`: those
// that take a few seconds under the sanitizers. worked_values_slow_test.cpp has the others.
namespace stereotlm::test {
namespace {

TEST(CoreWorkedValues, HoldForLineBuffer) {
  const auto statistics = run_one_frame("fpl2003-line-buffer", {"matcher.filter=none"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{309'223});
}

TEST(CoreWorkedValues, HoldForLineBufferWithLog7) {
  EXPECT_EQ(run_one_frame("fpl2003-line-buffer", {}).frame_cycles, Cycles{311'146});
}

TEST(CoreWorkedValues, HoldForWindow5) {
  const auto statistics = run_one_frame("fpl2003", {"matcher.filter=none", "matcher.window=5"});
  EXPECT_EQ(statistics.frame_cycles, Cycles{1'536'426});
  EXPECT_EQ(blame_of(statistics), std::vector<std::string>());
}

}  // namespace
}  // namespace stereotlm::test
