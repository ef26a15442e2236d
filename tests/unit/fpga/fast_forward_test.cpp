// How few cycles are stepped. The random cores, boards and computers compare what is counted with frames that
// are stepped and with the plain loops.
#include "models/fpga/fast/fast_forward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "models/fpga/frame_run.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// The board of the paper without filter and with a word cache: joint tables in one bank, pictures and
// disparities in another.
class FastForwardTest : public testing::Test {
 protected:
  static CoreConfig config() {
    CoreConfig config;
    config.filter.reset();
    config.joint_tables = true;
    config.pixel_cache = PixelCache::kWord;
    return config;
  }
  FastForwardTest() {
    bases.fill(registers::base(1, 0));
    bases[0] = registers::base(0, 0);
  }
  // The number of cycles that are stepped in each of three frames. Between two bursts of 32 words to the bank
  // of the tables the host pauses for `pause` cycles; 0: no bursts.
  std::vector<std::uint64_t> stepped_cycles(std::uint64_t pause) {
    std::vector<std::uint64_t> stepped;
    for (int frame = 0; frame < 3; ++frame) {
      const std::uint64_t begin = run.cycle() - run.skipped_cycles();
      run.start_direct(run.cycle(), bases, patterns);
      for (std::uint64_t first = run.cycle() + 10'000; pause != 0 && !run.control().frame_done();
           first += pause) {
        for (std::size_t left = 32; left > 0 && !run.control().frame_done();) {
          const FastForward::Served served = run.serve_host({0, true}, first, left);
          left -= served.words;
          if (served.words != 0) first = served.last_cycle + 1;
        }
      }
      run.run_ahead(UINT64_MAX);
      stepped.push_back(run.cycle() - run.skipped_cycles() - begin);
      run.finish();
      run.end();
    }
    return stepped;
  }

  FrameBases bases{};
  std::vector<memory::SsramBankConfig> banks = std::vector<memory::SsramBankConfig>(2);
  memory::Arbitration arbitration{core_arbiter(), banks};
  FrameRun run{config(), banks, arbitration, UINT64_MAX};
  AccessPatterns patterns{AccessPattern(FrameGeometry(config()), PixelCache::kWord),
                          AccessPattern(FrameGeometry(config()), PixelCache::kWord)};
};

// A frame has 2.15 million cycles. Those around its first row, its last row and its end are always stepped.
TEST_F(FastForwardTest, StepsFewCyclesOfAFrame) {
  for (const std::uint64_t cycles : stepped_cycles(0)) EXPECT_LT(cycles, 1000U);
}

TEST_F(FastForwardTest, StepsFewCyclesOfAFrameWithIrregularTablesOnceItsTransitionsAreRecorded) {
  std::vector<std::uint32_t> slanted(640 * 480);
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      slanted[place_of(config(), column, row)] = kernels::make_entry(
          std::min(639, column + column / 100 + row / 70), std::min(479, row + column / 80));
    }
  }
  patterns[0].set_entries(slanted.data());
  const std::vector<std::uint64_t> stepped = stepped_cycles(0);
  EXPECT_LT(stepped[0], 50'000U);
  EXPECT_LT(stepped[1], 1000U);
  EXPECT_EQ(stepped[2], stepped[1]);
}

// The bursts begin in many phases of a group of four columns.
TEST_F(FastForwardTest, StepsFewCyclesBesideBurstsOnceTheirGroupsAreRecorded) {
  const std::vector<std::uint64_t> stepped = stepped_cycles(901);
  EXPECT_LT(stepped[0], 50'000U);
  EXPECT_LT(stepped[2], 4000U);
}

}  // namespace
}  // namespace stereotlm::fpga
