#include "tests/integration/core/worked_values.h"

#include <gtest/gtest.h>

// Worked values at the end of contract section 2, through all modules, on the presets and with `--set`: those
// that take a few seconds under the sanitizers. worked_values_slow_test.cpp has the others.
namespace stereotlm::test {
namespace {

TEST_P(CoreWorkedValues, Hold) { expect_worked_values(GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Contract, CoreWorkedValues,
    testing::Values(WorkedFrame{"LineBuffer", "fpl2003-line-buffer", {"matcher.filter=none"}, 309'223},
                    WorkedFrame{"LineBufferWithLog7", "fpl2003-line-buffer", {}, 311'146},
                    WorkedFrame{
                        "Window5", "fpl2003", {"matcher.filter=none", "matcher.window=5"}, 1'536'426}),
    name_of);

}  // namespace
}  // namespace stereotlm::test
