#include "sw/cli/run_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/board_yaml.h"

namespace stereotlm::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Delivery {
  bool all_hold = false;
  std::string out;
  std::string err;
};

Delivery delivery_of(const std::vector<std::string>& failed) {
  RunInput input;
  input.board = platform::load_board("fpl2003");
  platform::Statistics statistics;
  statistics.frames = 1;
  statistics.failed = failed;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Delivery delivery;
  delivery.all_hold = deliver(input, statistics, kernels::GrayImage(4, 1));
  delivery.out = ::testing::internal::GetCapturedStdout();
  delivery.err = ::testing::internal::GetCapturedStderr();
  return delivery;
}

TEST(Deliver, IsContentWhereAllIdentitiesHold) {
  const Delivery delivery = delivery_of({});
  EXPECT_TRUE(delivery.all_hold);
  EXPECT_THAT(delivery.out, HasSubstr("worst stall"));
  EXPECT_THAT(delivery.err, IsEmpty());
}

TEST(Deliver, SaysEachIdentityThatDoesNotHold) {
  const Delivery delivery = delivery_of({"grants = 3: accesses = 4", "stalls = 5: blames = 6"});
  EXPECT_FALSE(delivery.all_hold);
  EXPECT_EQ(delivery.err,
            "stereotlm: error: identity does not hold: grants = 3: accesses = 4\n"
            "stereotlm: error: identity does not hold: stalls = 5: blames = 6\n");
  EXPECT_THAT(delivery.out, HasSubstr("worst stall")) << "the table is printed nevertheless";
}

}  // namespace
}  // namespace stereotlm::cli
