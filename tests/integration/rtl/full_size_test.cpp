#include <gtest/gtest.h>

#include <string>

#include "models/kernels/rectification_table.h"
#include "models/kernels/stereo.h"
#include "platform/assembly/preloaded_system.h"
#include "sw/media/load.h"
#include "tests/integration/rtl/rtl_board.h"

namespace stereotlm::test {
namespace {

// The paper's board with a photographed pair. `core`: of sets.json. Its cycles are those of the worked values
// of contract sections 2 and 7.
void expect_worked_values(const std::string& core, int result_delay_cycles, int pipeline_latency_cycles) {
  platform::BoardConfig board;
  board.fpga.result_delay_cycles = result_delay_cycles;
  board.fpga.pipeline_latency_cycles = pipeline_latency_cycles;
  board.banks.resize(5);
  board.allocation = {{"bank0"}, {"bank1"}, {"bank2"}, "bank3", "bank4"};
  const auto table = kernels::identity_table(board.image.width, board.image.height);
  const std::string pictures = STEREOTLM_PICTURES;
  const host::StereoPair pair = {media::load_gray(pictures + "/left01.jpg").image,
                                 media::load_gray(pictures + "/right01.jpg").image};
  constexpr std::uint64_t kCycles = 2'151'016;

  const std::unique_ptr<RtlCore> verilated = rtl_cores().at(core)();
  RtlBoard rtl(board, {table, table}, *verilated);
  const kernels::GrayImage disparity =
      rtl.run_frame(pair, true, kCycles, [](std::uint64_t /*frame*/, const RtlOutputs& /*outputs*/) {});
  EXPECT_EQ(rtl.frame_cycles(), std::vector<std::uint64_t>{kCycles});
  EXPECT_EQ(platform::run_core(board, {table, table}, 1).frame_cycles, rtl.frame_cycles());
  EXPECT_EQ(disparity.pixels, kernels::disparity_image(pair.left, pair.right, &table, &table, {}).pixels);
}

TEST(RtlFullSize, IsTheModelOnAPhotographedPair) { expect_worked_values("full_size", 0, 16); }

TEST(RtlFullSize, IsTheModelWithItsPipelineBeforeTheQueue) {
  expect_worked_values("full_size_delayed", 16, 0);
}

}  // namespace
}  // namespace stereotlm::test
