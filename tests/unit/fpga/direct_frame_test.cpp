#include "models/fpga/direct_frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "models/kernels/rectification_table.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

TEST(DirectFrame, DecodesJointTablesAgainOnlyIfTheyOrARegisterMayHaveChanged) {
  CoreConfig core = small_core(8, 6);
  core.joint_tables = true;
  core.pixel_cache = PixelCache::kWord;
  DirectFrame frame(core, true);
  const kernels::RectificationTable table = kernels::identity_table(8, 6);
  kernels::JointTable joint = kernels::join_tables({8, 6, table.entries}, {8, 6, table.entries});
  const std::vector<std::uint8_t> image(8 * 6);
  std::vector<std::uint8_t> disparities(8 * 6);
  DirectFrame::Memory memory;
  memory.images = {image.data(), image.data()};
  memory.disparities = disparities.data();
  memory.tables[0].entries = joint.words.data();
  memory.joint_offsets = joint.offsets;
  const auto reads = [&](bool may_have_changed) {
    memory.tables[0].may_have_changed = may_have_changed;
    return frame.read(memory);
  };
  EXPECT_TRUE(reads(false));  // for the first time
  joint.words[0] |= 0x7FFFU;  // the largest displacements: outside the image
  EXPECT_TRUE(reads(false));
  EXPECT_FALSE(reads(true));
  EXPECT_FALSE(reads(false));
  joint.words[0] = 0;
  EXPECT_TRUE(reads(true));
  for (kernels::JointOffset& offset : memory.joint_offsets) {  // a register moves all sources of a side
    offset.rows += 6;
    EXPECT_FALSE(reads(false));
    offset.rows -= 6;
    EXPECT_TRUE(reads(false));
  }
}

}  // namespace
}  // namespace stereotlm::fpga
