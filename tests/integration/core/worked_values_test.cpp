#include "tests/integration/core/worked_values.h"

#include <gtest/gtest.h>

// Worked values at the end of contract section 2, through all modules, on the presets and with `--set`: those
// that take a few seconds under the sanitizers. worked_values_slow_test.cpp has the others.
namespace stereotlm::test {
namespace {

TEST_P(CoreWorkedValues, Hold) { expect_worked_values(GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Contract, CoreWorkedValues,
    testing::Values(
        WorkedFrame{"LineBuffer", "fpl2003-line-buffer", {"matcher.filter=none"}, 309'223},
        WorkedFrame{"LineBufferWithLog7", "fpl2003-line-buffer", {}, 311'146},
        WorkedFrame{"Units40WithLineBuffer",
                    "fpl2003-line-buffer",
                    {"matcher.filter=none", "matcher.units=40"},
                    618'425},
        WorkedFrame{"Window5", "fpl2003", {"matcher.filter=none", "matcher.window=5"}, 1'536'426},
        WorkedFrame{"AllInAQdrBank",
                    "fpl2003",
                    {"image={width: 64, height: 49}",
                     "matcher={window: 5, disparities: 16, filter: none, fetch: line_buffer, "
                     "lr_tolerance: 0}",
                     "fpga.result_fifo_words=1", "fpga.arbitration=round_robin",
                     "fpga.priority=[host, right_lut, left_lut, right_pixel, left_pixel, result]",
                     "ssram.banks={bank0: {kind: qdr}}",
                     "allocation={left_image: bank0, right_image: bank0, disparity: bank0, "
                     "left_lut: bank0, right_lut: bank0}"},
                    12'744,
                    {"left_lut in bank0 by right_lut: 3136", "left_lut in bank0 by left_pixel: 3135",
                     "left_lut in bank0 by right_pixel: 3135", "right_lut in bank0 by left_lut: 3135",
                     "right_lut in bank0 by left_pixel: 3135", "right_lut in bank0 by right_pixel: 3135"}}),
    name_of);

}  // namespace
}  // namespace stereotlm::test
