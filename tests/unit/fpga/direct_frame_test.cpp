#include "models/fpga/fast/direct_frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "models/kernels/rectification_table.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// Banks that hold a buffer each.
struct Buffers : memory::DirectBanks {
  Buffers() : DirectBanks(kCorePortCount) {}
  unsigned char* direct(std::uint64_t address, std::uint64_t /*bytes*/) override {
    return of_port[memory::bank_of_address(address)];
  }
  void allow_access(memory::Port /*port*/) override {}
  bool may_have_changed(memory::Port, std::uint64_t, std::uint64_t) override { return have_changed; }

  std::array<unsigned char*, kCorePortCount> of_port{};
  bool have_changed = true;
};

unsigned char* bytes_of(std::vector<std::uint32_t>& words) {
  return reinterpret_cast<unsigned char*>(words.data());
}

// A frame with joint tables, whose sides need different offsets, and the same frame with separate tables.
class DirectFrameJointTables : public testing::Test {
 protected:
  DirectFrameJointTables() {
    test::SplitMix64 random(1);
    for (std::uint8_t& pixel : image) pixel = static_cast<std::uint8_t>(random.between(0, 255));
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 7; ++column) {
        const std::size_t pixel = static_cast<std::size_t>(8 * row + column);
        tables[0][pixel] = kernels::make_entry(column + 1, row);
        tables[1][pixel] = kernels::make_entry(column, row + 1);
      }
    }
    tables[1][9] = 0;
    joint = kernels::join_tables({8, 6, tables[0]}, {8, 6, tables[1]});
    separate_buffers.of_port = {bytes_of(tables[0]), bytes_of(tables[1]), image.data(), image.data(),
                                separate_disparities.data()};
    joint_buffers.of_port = {bytes_of(joint.words), nullptr, image.data(), image.data(), disparities.data()};
    for (std::uint32_t port = 0; port < kCorePortCount; ++port) bases[port] = registers::base(port, 0);
    joint_frame.set_buffers(bases);
  }
  static CoreConfig config(bool has_joint_tables) {
    CoreConfig core = small_core(8, 6);
    core.joint_tables = has_joint_tables;
    core.pixel_cache = PixelCache::kWord;
    return core;
  }
  // Expects the accesses and disparities of the separate tables.
  void expect_separate() {
    DirectFrame separate(config(false), true, separate_buffers);
    separate.set_buffers(bases);
    ASSERT_TRUE(separate.read({}));
    EXPECT_TRUE(separate.write());
    EXPECT_TRUE(joint_frame.write());
    EXPECT_EQ(disparities, separate_disparities);
    for (const std::size_t side : {0U, 1U}) {
      const AccessPattern& found = joint_frame.patterns()[side];
      EXPECT_EQ(found.pixel_accesses(), separate.patterns()[side].pixel_accesses()) << side;
    }
  }
  bool reads(std::size_t pixel, std::uint32_t word, bool may_have_changed = true) {
    joint.words[pixel] = word;
    joint_buffers.have_changed = may_have_changed;
    return joint_frame.read(joint.offsets);
  }

  std::array<std::vector<std::uint32_t>, 2> tables{kernels::identity_table(8, 6).entries,
                                                   kernels::identity_table(8, 6).entries};
  std::vector<std::uint8_t> image = std::vector<std::uint8_t>(8 * 6);
  std::vector<std::uint8_t> disparities = image;
  std::vector<std::uint8_t> separate_disparities = image;
  kernels::JointTable joint;
  FrameBases bases{};
  Buffers separate_buffers;
  Buffers joint_buffers;
  DirectFrame joint_frame{config(true), true, joint_buffers};
};

TEST_F(DirectFrameJointTables, AreDecodedInTheFirstFrameAlsoIfTheyHaveNotChanged) {
  joint_buffers.have_changed = false;
  ASSERT_TRUE(joint_frame.read(joint.offsets));
  expect_separate();
}

TEST_F(DirectFrameJointTables, AreDecodedAgainOnlyIfTheyOrARegisterMayHaveChanged) {
  ASSERT_TRUE(joint_frame.read(joint.offsets));
  EXPECT_TRUE(reads(0, 0, false));
  expect_separate();
  EXPECT_TRUE(reads(0, 0));
  tables[0][0] = tables[1][0] = 0;
  expect_separate();
  // One pixel to the right, in place of one to the left.
  for (std::uint32_t& word : joint.words)
    if ((word >> 31U) != 0) word -= 1U << 16U;
  ++joint.offsets[0].columns;
  ASSERT_TRUE(reads(0, 0, false));
  expect_separate();
}

TEST_F(DirectFrameJointTables, AreNotReadIfAnEntryOfEitherSidePointsOutsideTheImage) {
  ASSERT_TRUE(joint_frame.read(joint.offsets));
  constexpr std::uint32_t kNowhere = 0x7FFF;  // the largest displacements
  const std::uint32_t word = joint.words[0];
  for (const unsigned side : {16U, 0U}) {
    const std::uint32_t other = word & ~(0xFFFFU << side);
    EXPECT_TRUE(reads(0, other | kNowhere << side)) << "not valid";
    EXPECT_FALSE(reads(0, other | (0x8000U | kNowhere) << side));
    EXPECT_FALSE(reads(0, other | (0x8000U | kNowhere) << side, false));
    EXPECT_TRUE(reads(0, word));
  }
  // A register moves all sources of a side.
  for (kernels::JointOffset& offset : joint.offsets) {
    offset.rows += 6;
    EXPECT_FALSE(reads(0, word, false));
    offset.rows -= 6;
    EXPECT_TRUE(reads(0, word, false));
  }
  joint_buffers.of_port[0] = nullptr;
  EXPECT_FALSE(joint_frame.read(joint.offsets));
}

}  // namespace
}  // namespace stereotlm::fpga
