#include "models/fpga/frame_counts.h"

#include <gtest/gtest.h>

#include "models/fpga/frame_run.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

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
  CoreConfig config_ = small_core(16, 6);
  std::vector<memory::SsramBankConfig> banks_ = std::vector<memory::SsramBankConfig>(kPortCount);
  memory::Arbitration arbitration_{core_arbiter(), banks_};
  FrameRun run_{config_, banks_, arbitration_, UINT64_MAX};
  AccessPatterns patterns_{AccessPattern(geometry(), PixelCache::kNone),
                           AccessPattern(geometry(), PixelCache::kNone)};
};

// Slots and words are taken from the control, so that a control that has done too little is found: its counts
// differ from the counts of the geometry.
TEST_F(FrameCountsTest, HaveTheSlotsAndWordsThatTheControlHasComeTo) {
  // From cycle 4 on one slot is consumed per cycle. A column has three slots.
  const std::uint64_t columns = geometry().result_delay_columns + 8;
  struct Expected {
    std::uint64_t end;
    std::uint64_t slots;
    std::uint64_t words;
  };
  for (const Expected& expected : {Expected{1, 1, 0}, Expected{4 + 3 * columns - 1, 4 + 3 * columns - 1, 1},
                                   Expected{4 + 3 * columns, 4 + 3 * columns, 2},
                                   Expected{UINT64_MAX, geometry().slots, geometry().result_words}}) {
    const FrameCounts found = counts(expected.end);
    for (const FrameCounts::Lane& lane : found.lanes) EXPECT_EQ(lane.slots.slots, expected.slots);
    EXPECT_EQ(found.packed.words, expected.words);
  }
}

}  // namespace
}  // namespace stereotlm::fpga
