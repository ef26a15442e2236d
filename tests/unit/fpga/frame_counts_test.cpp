#include "models/fpga/frame_counts.h"

#include <gtest/gtest.h>

#include "models/fpga/frame_run.h"

namespace stereotlm::fpga {
namespace {

CoreConfig small_core() {
  CoreConfig config;
  config.width = 16;
  config.height = 6;
  config.window = 3;
  config.disparities = 3;
  config.filter.reset();
  return config;
}

// A frame in which no port contends.
class FrameCountsTest : public testing::Test {
 protected:
  FrameCountsTest() {
    FrameBases bases{};
    for (std::uint32_t port = 0; port < kCorePortCount; ++port) bases[port] = registers::base(port, 0);
    run_.start_direct(0, bases, patterns_);
  }
  // After the cycles of the frame before `end`.
  FrameCounts counts(std::uint64_t end) {
    run_.run_ahead(end);
    return {config_, patterns_, run_, std::nullopt};
  }
  const FrameGeometry& geometry() const { return run_.control().geometry(); }

 private:
  CoreConfig config_ = small_core();
  std::vector<memory::SsramBankConfig> banks_ = std::vector<memory::SsramBankConfig>(memory::kPortCount);
  memory::Arbitration arbitration_{memory::ArbiterConfig{}, banks_};
  FrameRun run_{config_, banks_, arbitration_, UINT64_MAX};
  AccessPatterns patterns_{AccessPattern(geometry()), AccessPattern(geometry())};
};

TEST_F(FrameCountsTest, HaveTheSlotsAndWordsOfTheGeometryAtTheEnd) {
  const FrameCounts whole = counts(UINT64_MAX);
  EXPECT_EQ(whole.lanes[0].slots.slots, geometry().slots);
  EXPECT_EQ(whole.lanes[1].slots.slots, geometry().slots);
  EXPECT_EQ(whole.packed.words, geometry().result_words);
}

// A control that has not done what it should is noticed: its counts are not those of the geometry.
TEST_F(FrameCountsTest, HaveTheSlotsAndWordsThatTheControlHasComeTo) {
  const FrameCounts early = counts(1);
  EXPECT_EQ(early.lanes[0].slots.slots, 1U);
  EXPECT_EQ(early.lanes[1].slots.slots, 1U);
  EXPECT_EQ(early.packed.words, 0U);
  // From cycle 4 on a slot is consumed a cycle, three of them a column.
  const std::uint64_t columns = geometry().result_delay_columns + 8;
  EXPECT_EQ(counts(4 + 3 * columns - 1).packed.words, 1U);
  const FrameCounts later = counts(4 + 3 * columns);
  EXPECT_EQ(later.packed.words, 2U);
  EXPECT_EQ(later.lanes[0].slots.slots, 4 + 3 * columns);
  EXPECT_EQ(later.lanes[1].slots.slots, 4 + 3 * columns);
}

}  // namespace
}  // namespace stereotlm::fpga
