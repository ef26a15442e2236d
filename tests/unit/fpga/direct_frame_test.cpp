#include "models/fpga/fast/direct_frame.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "models/kernels/rectification_table.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// Banks that hold a buffer each.
struct Buffers : memory::DirectBanks {
  Buffers() : DirectBanks(kCoreGroupCount) {}
  unsigned char* direct(std::uint64_t address, std::uint64_t /*bytes*/) override {
    return of_port[memory::bank_of_address(address)];
  }
  void allow_access(memory::Port /*port*/) override {}

  std::array<unsigned char*, kCoreGroupCount> of_port{};
};

TEST(DirectFrame, DecodesJointTablesAgainOnlyIfTheyOrARegisterMayHaveChanged) {
  CoreConfig core = small_core(8, 6);
  core.joint_tables = true;
  core.pixel_cache = PixelCache::kWord;
  const kernels::RectificationTable table = kernels::identity_table(8, 6);
  kernels::JointTable joint = kernels::join_tables({8, 6, table.entries}, {8, 6, table.entries});
  std::vector<std::uint8_t> image(8 * 6);
  std::vector<std::uint8_t> disparities(8 * 6);
  Buffers buffers;
  buffers.of_port = {reinterpret_cast<unsigned char*>(joint.words.data()), nullptr, image.data(),
                     image.data(), disparities.data()};
  DirectFrame frame(core, true, buffers);
  FrameBases bases{};
  for (std::uint32_t port = 0; port < kCoreGroupCount; ++port) bases[port] = registers::base(port, 0);
  frame.set_buffers(bases);
  const auto reads = [&](bool may_have_changed) {
    if (may_have_changed) buffers.changes(0, UINT64_MAX);
    return frame.read(joint.offsets);
  };
  EXPECT_TRUE(reads(false));  // for the first time
  joint.words[0] |= 0x7FFFU;  // the largest displacements: outside the image
  EXPECT_TRUE(reads(false));
  EXPECT_FALSE(reads(true));
  EXPECT_FALSE(reads(false));
  joint.words[0] = 0;
  EXPECT_TRUE(reads(true));
  for (kernels::JointOffset& offset : joint.offsets) {  // a register moves all sources of a side
    offset.rows += 6;
    EXPECT_FALSE(reads(false));
    offset.rows -= 6;
    EXPECT_TRUE(reads(false));
  }
}

}  // namespace
}  // namespace stereotlm::fpga
