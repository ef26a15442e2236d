#include "models/fpga/direct_frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "models/kernels/rectification_table.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

using memory::Port;

constexpr std::uint32_t kFirst = 100;  // word, of each buffer in its bank

// A bank for each buffer.
FrameBases bases_of_frame() {
  FrameBases bases{};
  for (std::uint32_t port = 0; port < kCorePortCount; ++port) bases[port] = registers::base(port, kFirst);
  return bases;
}

std::uint32_t words_of(std::size_t port) {
  return 8 * 6 * static_cast<std::uint32_t>(kPorts[port].bytes_per_pixel) / 4;
}

TEST(DirectFrame, FindsDisparitiesThatOverlapAnotherBuffer) {
  DirectFrame frame(small_core(8, 6), false);
  frame.set_buffers(bases_of_frame());
  EXPECT_TRUE(frame.disparities_are_apart());
  const std::uint32_t own_words = words_of(kResultPort);
  for (std::uint32_t other = 0; other < kResultPort; ++other) {
    const auto is_apart = [&](std::uint32_t first_word) {
      FrameBases moved = bases_of_frame();
      moved[kResultPort] = registers::base(other, first_word);
      frame.set_buffers(moved);
      return frame.disparities_are_apart();
    };
    EXPECT_TRUE(is_apart(kFirst - own_words)) << other;
    EXPECT_FALSE(is_apart(kFirst - own_words + 1)) << other;
    EXPECT_FALSE(is_apart(kFirst + words_of(other) - 1)) << other;
    EXPECT_TRUE(is_apart(kFirst + words_of(other))) << other;
  }
}

TEST(DirectFrame, FindsTheHazardOfAnAccess) {
  DirectFrame frame(small_core(8, 6), false);
  frame.set_buffers(bases_of_frame());
  for (std::uint32_t index = 0; index < kCorePortCount; ++index) {
    const Port port = index;
    const auto hazard = [&](std::uint32_t word, bool write) {
      const std::uint64_t address = registers::base_address(registers::base(index, word));
      return frame.hazard_with({address, address + 4}, write);
    };
    const std::uint32_t behind = kFirst + words_of(index);
    for (const std::uint32_t word : {kFirst, behind - 1}) {
      EXPECT_EQ(hazard(word, true), port) << index;
      EXPECT_EQ(hazard(word, false), port == kResultPort ? std::optional(port) : std::nullopt) << index;
    }
    for (const std::uint32_t word : {kFirst - 1, behind})
      EXPECT_EQ(hazard(word, true), std::nullopt) << index;
  }
}

TEST(DirectFrame, HasNoHazardWithATableThatItsCoreDoesNotHave) {
  CoreConfig config = small_core(8, 6);
  config.left_table = false;
  DirectFrame frame(config, false);
  frame.set_buffers(bases_of_frame());
  const std::uint64_t address = registers::base_address(bases_of_frame()[lut_port(Side::kLeft)]);
  EXPECT_EQ(frame.hazard_with({address, address + 4}, true), std::nullopt);
}

// Memory of a frame with identity tables.
class DirectFrameMemory : public testing::Test {
 protected:
  DirectFrameMemory() {
    for (std::size_t side = 0; side < 2; ++side) {
      memory.tables[side].entries = tables[side].data();
      memory.images[side] = image.data();
    }
    memory.disparities = disparities.data();
  }
  bool reads_left_entry(std::uint32_t entry, bool may_have_changed = true) {
    tables[0][5] = entry;
    memory.tables[0].may_have_changed = may_have_changed;
    return frame.read(memory);
  }

  std::array<std::vector<std::uint32_t>, 2> tables{kernels::identity_table(8, 6).entries,
                                                   kernels::identity_table(8, 6).entries};
  std::vector<std::uint8_t> image = std::vector<std::uint8_t>(8 * 6);
  std::vector<std::uint8_t> disparities = image;
  DirectFrame::Memory memory;
  DirectFrame frame{small_core(8, 6), true};
};

TEST_F(DirectFrameMemory, IsReadOnlyIfAllOfItGrantsDirectAccess) {
  EXPECT_TRUE(frame.read(memory));
  const auto reads_without = [this](auto change) {
    DirectFrame::Memory less = memory;
    change(less);
    return frame.read(less);
  };
  for (const std::size_t side : {0U, 1U}) {
    EXPECT_FALSE(reads_without([side](auto& less) { less.tables[side].entries = nullptr; }));
    EXPECT_FALSE(reads_without([side](auto& less) { less.images[side] = nullptr; }));
  }
  EXPECT_FALSE(reads_without([](auto& less) { less.disparities = nullptr; }));
}

TEST_F(DirectFrameMemory, IsNotReadIfAValidEntryPointsOutsideTheImage) {
  for (const std::uint32_t outside : {kernels::make_entry(8, 5), kernels::make_entry(7, 6)}) {
    EXPECT_FALSE(reads_left_entry(outside));
    EXPECT_TRUE(reads_left_entry(outside & ~kernels::kEntryValid));
  }
  EXPECT_TRUE(reads_left_entry(kernels::make_entry(7, 5)));
}

TEST_F(DirectFrameMemory, HasTheAccessesOfATableThatMayHaveChanged) {
  ASSERT_TRUE(frame.read(memory));
  const std::uint64_t all = frame.patterns()[0].pixel_accesses();
  EXPECT_TRUE(reads_left_entry(0, false));
  EXPECT_EQ(frame.patterns()[0].pixel_accesses(), all);
  EXPECT_TRUE(reads_left_entry(0));
  EXPECT_LT(frame.patterns()[0].pixel_accesses(), all);
  EXPECT_FALSE(reads_left_entry(kernels::make_entry(8, 0)));
  EXPECT_FALSE(reads_left_entry(kernels::make_entry(8, 0), false));
}

}  // namespace
}  // namespace stereotlm::fpga
