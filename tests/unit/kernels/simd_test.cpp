#include "models/kernels/simd.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::kernels {
namespace {

TEST(Simd, ListsTheInstructionSetsOfTheMachineBestFirst) {
  int lanes = kMostFrameLanes;
  for (const Simd* simd : simd_sets_from(nullptr)) {
    EXPECT_LE(simd->lanes, lanes) << simd->name;
    lanes = simd->lanes;
    EXPECT_EQ(simd_sets_from(simd->name).front(), simd);
  }
  EXPECT_EQ(simd_sets_from("base").size(), 1U);
}

TEST(Simd, RefusesASetThatTheMachineDoesNotHave) {
  EXPECT_THROW(simd_sets_from("mmx"), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
