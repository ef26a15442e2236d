#include "models/fpga/frame_counts.h"

#include <gtest/gtest.h>

#include "models/fpga/core_timing.h"

namespace stereotlm::fpga {
namespace {

using memory::Port;

CoreConfig small_core() {
  CoreConfig config;
  config.width = 16;
  config.height = 6;
  config.window = 3;
  config.disparities = 3;
  config.filter.reset();
  return config;
}

// A frame in which nothing contends.
class FrameCountsTest : public testing::Test {
 protected:
  FrameCountsTest() {
    for (const Port port : {Port::kLeftLut, Port::kRightLut, Port::kLeftPixel, Port::kRightPixel})
      arbitration_.route(port, memory::index_of(port), false);
    arbitration_.route(Port::kResult, memory::index_of(Port::kResult), true);
    timing_.start_frame({}, pattern_, pattern_);
  }
  // After the frame's cycles before `end`.
  FrameCounts counts(std::uint64_t end) {
    cycle_ = timing_.run_ahead(cycle_, end);
    return {config_, pattern_, pattern_, timing_.control(), 0};
  }
  const FrameGeometry& geometry() const { return timing_.control().geometry(); }

 private:
  CoreConfig config_ = small_core();
  memory::Arbitration arbitration_{memory::ArbiterConfig{},
                                   std::vector<memory::SsramBankConfig>(memory::kPortCount)};
  CoreTiming timing_{config_, arbitration_};
  AccessPattern pattern_{timing_.control().geometry()};
  std::uint64_t cycle_ = 0;
};

TEST_F(FrameCountsTest, HaveTheSlotsAndWordsOfTheGeometryAtTheEnd) {
  const FrameCounts whole = counts(UINT64_MAX);
  EXPECT_EQ(whole.left.slots.slots, geometry().slots);
  EXPECT_EQ(whole.right.slots.slots, geometry().slots);
  EXPECT_EQ(whole.packed.words, geometry().result_words);
}

// A control that has not done what it should is noticed: its counts are not those of the geometry.
TEST_F(FrameCountsTest, HaveTheSlotsAndWordsThatTheControlHasComeTo) {
  const FrameCounts early = counts(1);
  EXPECT_EQ(early.left.slots.slots, 1U);
  EXPECT_EQ(early.right.slots.slots, 1U);
  EXPECT_EQ(early.packed.words, 0U);
  // From cycle 4 on a slot is consumed a cycle, three of them a column.
  const std::uint64_t columns = geometry().result_delay_columns + 8;
  EXPECT_EQ(counts(4 + 3 * columns - 1).packed.words, 1U);
  const FrameCounts later = counts(4 + 3 * columns);
  EXPECT_EQ(later.packed.words, 2U);
  EXPECT_EQ(later.left.slots.slots, 4 + 3 * columns);
  EXPECT_EQ(later.right.slots.slots, 4 + 3 * columns);
}

}  // namespace
}  // namespace stereotlm::fpga
