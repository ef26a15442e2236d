// Frames: when they begin and end, what they compute, and what is refused.
#include "models/fpga/stereo_core.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "models/testing/expected_report.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/fpga/stereo_core_bench.h"

namespace stereotlm::fpga {
namespace {

using memory::BankKind;
using registers::kStatusBusy;
using registers::kStatusDone;
using registers::kStatusError;
using sc_core::sc_time;

class StereoCoreTest : public StereoCoreFidelities {
 protected:
  std::vector<std::uint32_t> expected_words() const {
    test::ReferenceInput input;
    input.width = config.core.width;
    input.height = config.core.height;
    input.left = left;
    input.right = right;
    if (config.core.filter)
      input.filter = {config.core.filter->size, config.core.filter->weights, config.core.filter->shift};
    input.window = config.core.window;
    input.disparities = config.core.disparities;
    input.lr_tolerance = config.core.lr_tolerance;
    return test::compute_reference(input).disparity_words;
  }
  std::vector<std::uint32_t> result_words() {
    return memory.debug_read(memory::crossbar_address(kResult, 0),
                             static_cast<std::size_t>(config.core.width * config.core.height / 4));
  }
};

TEST_P(StereoCoreTest, BeginsInTheFirstCycleAtOrAfterItsStrobe) {
  build(small_board());
  struct Strobe {
    sc_time at;
    sc_time delay;  // that its access carries
    std::uint64_t first_cycle;
  };
  const std::vector<Strobe> strobes = {{edge(10), {}, 10},
                                       {edge(1000) - kPicosecond, {}, 1000},
                                       {edge(2000) + kPicosecond, {}, 2001},
                                       {edge(3000), edge(3), 3003}};
  std::vector<sc_time> ends;
  for (const Strobe& strobe : strobes) {
    at(strobe.at, [this, strobe] {
      const auto value = registers::kControlStart | registers::kControlAcknowledge;
      registers.write(registers::kControl, value, strobe.delay);
    });
    ends.push_back(edge(strobe.first_cycle + frame_cycles_alone(4)));
  }
  finish();
  EXPECT_EQ(done_at, ends);
}

TEST_P(StereoCoreTest, IsBusyUntilTheLastPicosecondOfTheFrame) {
  build(small_board());
  at(edge(0), [this] { start(); });
  run_until(edge(frame_cycles_alone(4)) - kPicosecond);
  EXPECT_EQ(status(), kStatusBusy);
  EXPECT_FALSE(done.read());
  EXPECT_TRUE(frame_cycles().empty());
  run_until(edge(frame_cycles_alone(4)) + kPicosecond);
  EXPECT_EQ(status(), kStatusDone);
  EXPECT_TRUE(done.read());
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(registers.read(registers::kFrameCyclesLow).word, frame_cycles_alone(4));
  EXPECT_EQ(registers.read(registers::kFrameCyclesHigh).word, 0U);
}

TEST_P(StereoCoreTest, LeavesTheRunningFrameAloneWhenAnotherStrobeComes) {
  build(small_board());
  start();
  at(edge(20), [this] {
    set_base(registers::kDisparityBase, kSpare);
    control(registers::kControlStart);
  });
  finish();
  EXPECT_EQ(status(), kStatusDone | kStatusError);
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(result_words(), expected_words());
}

TEST_P(StereoCoreTest, IsBusyForAStrobeAPicosecondBeforeTheEndOfAFrameAndFreeAtTheEnd) {
  build(small_board());
  const std::uint64_t cycles = frame_cycles_alone(4);
  at(edge(0), [this] { start(); });
  at(edge(cycles) - kPicosecond, [this] { control(registers::kControlStart); });
  at(edge(2 * cycles), [this] { control(registers::kControlAcknowledge); });
  at(edge(3 * cycles), [this] { start(); });
  on_done = [this] {
    if (frame_cycles().size() == 2) start();
  };
  run_until(edge(cycles) + kPicosecond);
  EXPECT_EQ(status(), kStatusDone | kStatusError);
  finish();
  EXPECT_EQ(status(), kStatusDone);
  EXPECT_EQ(done_at, (std::vector<sc_time>{edge(cycles), edge(4 * cycles), edge(5 * cycles)}));
}

class StereoCoreBases : public StereoCoreBench, public testing::WithParamInterface<memory::Port> {
 protected:
  const PortGroup& tested() const { return kPortGroups[GetParam()]; }
  void run_frame_on(std::uint32_t bank, std::uint32_t word = 0) {
    set_base(tested().base_register, bank, word);
    start();
    finish();
  }
};

TEST_P(StereoCoreBases, MustLieInABankThatTheBoardHas) {
  build(small_board());
  run_frame_on(kBankCount);
  EXPECT_EQ(status(), kStatusError);
  EXPECT_TRUE(done_at.empty());
  EXPECT_TRUE(frame_cycles().empty());
  for (std::uint32_t bank = 0; bank < kBankCount; ++bank) EXPECT_EQ(accesses(bank), 0U);
  run_frame_on(kSpare);
  EXPECT_EQ(status(), kStatusDone);
}

TEST_P(StereoCoreBases, RaiseErrorBehindABanksEndAndTheFrameEnds) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build(small_board());
  // The last word of the buffer of 8 x 6 pixels lies just inside, then just outside.
  const auto last_fit = static_cast<std::uint32_t>(kWords - 8 * 6 * tested().bytes_per_pixel / 4);
  memory.debug_write(memory::crossbar_address(kSpare, last_fit),
                     std::vector<std::uint32_t>(kWords - last_fit, kernels::kEntryValid));
  run_frame_on(kSpare, last_fit);
  EXPECT_EQ(status(), kStatusDone);
  run_frame_on(kSpare, last_fit + 1);
  EXPECT_EQ(status(), kStatusDone | kStatusError);
  EXPECT_EQ(frame_cycles().size(), 2U);
  EXPECT_GT(banks[kSpare]->stats().errors, 0U);
  run_frame_on(kSpare, last_fit);
  EXPECT_EQ(status(), kStatusDone);
}

INSTANTIATE_TEST_SUITE_P(StereoCore, StereoCoreBases, testing::Range(std::size_t{0}, kCoreGroupCount),
                         [](const auto& suite) { return std::string(kPortGroups[suite.param].name); });

TEST_P(StereoCoreTest, RefusesAConfigurationWithProblems) {
  std::vector<StereoCoreConfig> refused(4, small_board());
  refused[0].core.window = 4;
  refused[1].memory.banks.clear();
  refused[2].memory.arbiter.priority = {0, 1, 2, 3, 4};
  refused[3].core.clock_mhz += 1;
  for (const StereoCoreConfig& board : refused)
    EXPECT_THROW(StereoCore("refused", board, binder), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, StereoCoreTest, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         name_of_fidelity);

}  // namespace
}  // namespace stereotlm::fpga
