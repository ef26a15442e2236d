#include "models/kernels/simd.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace stereotlm::kernels {
namespace {

TEST(Simd, ListsTheInstructionSetsOfTheMachineBestFirst) {
  int lanes = kMostFrameLanes;
  for (const Simd* simd : simd_sets()) {
    EXPECT_LE(simd->frame.lanes, lanes) << simd->name;
    lanes = simd->frame.lanes;
  }
  EXPECT_EQ(simd_sets().back()->name, std::string("base"));
}

// Each test is a process of its own, in which the variable is read once.
TEST(Simd, UsesNoBetterSetThanTheEnvironmentNames) {
  setenv("STEREOTLM_VECTORS", "base", 1);
  EXPECT_EQ(simd_sets().size(), 1U);
  EXPECT_EQ(best_simd().name, std::string("base"));
}

TEST(Simd, RefusesASetThatTheMachineDoesNotHave) {
  setenv("STEREOTLM_VECTORS", "mmx", 1);
  EXPECT_THROW(simd_sets(), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
