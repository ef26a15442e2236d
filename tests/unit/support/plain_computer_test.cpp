#include "tests/support/plain_computer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/support/random_computer.h"

namespace stereotlm::test {
namespace {

ReferenceInput camera_input(const RandomBoard& board, std::uint64_t camera_frame) {
  ReferenceInput input = reference_input(board, 0);
  const PicturePair pair = camera_pictures(board, camera_frame);
  input.left = pair.left;
  input.right = pair.right;
  return input;
}

// The pictures reach the board whole, and the tables as the core reads them: joint tables with their
// registers give what separate tables give.
TEST(PlainComputer, DeliversTheDisparitiesOfThePicturesWithAllKnobs) {
  RandomKnobs knobs = RandomKnobs::all();
  knobs.large_images = false;
  int compared = 0;
  int joint = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomComputer computer = make_random_computer(seed, knobs);
    const PlainComputerResult result = run_plain_computer(computer.input);
    ASSERT_EQ(result.deliveries.size(), static_cast<std::size_t>(computer.input.frames));
    EXPECT_EQ(result.core.frame_cycles.size(), result.deliveries.size());
    const bool is_whole = std::all_of(result.cameras.begin(), result.cameras.end(),
                                      [](const auto& camera) { return camera.capture.dropped_pixels == 0; });
    if (!is_whole) continue;
    for (const PlainDelivery& delivery : result.deliveries) {
      const ReferenceResult expected = compute_reference(camera_input(computer.board, delivery.camera_frame));
      ASSERT_EQ(delivery.disparity, expected.disparity);
      ++compared;
      joint += computer.board.joint_tables ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 60);
  EXPECT_GT(joint, 20);
}

TEST(PlainComputer, UploadsOneJointTable) {
  RandomComputer computer = make_random_computer(0);
  PlainComputerInput& input = computer.input;
  PlainCycleInput& core = input.board.core;
  core.left_lut = core.right_lut = 0;
  core.left_table.reset();
  core.right_table.reset();
  const PlainComputerResult separate = run_plain_computer(input);
  core.joint_tables = true;
  const PlainComputerResult joint = run_plain_computer(input);
  const auto table_words = static_cast<std::uint64_t>(core.width * core.height);
  EXPECT_EQ(separate.dma_words - joint.dma_words, table_words);
}

}  // namespace
}  // namespace stereotlm::test
