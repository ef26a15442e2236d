#include "sw/runs/run_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "platform/config/board_yaml.h"

namespace stereotlm::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Delivery {
  bool all_hold = false;
  std::string out;
  std::string err;
};

Delivery delivery_of(const std::vector<std::string>& failed,
                     const std::vector<std::string>& differences = {}) {
  RunInput input;
  input.board = platform::load_board("fpl2003");
  input.pairs = blank_pairs(input.board);
  platform::Statistics statistics;
  statistics.frames = 1;
  statistics.failed = failed;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Delivery delivery;
  delivery.all_hold = deliver(input, statistics, {0, kernels::GrayImage(4, 1)}, differences);
  delivery.out = ::testing::internal::GetCapturedStdout();
  delivery.err = ::testing::internal::GetCapturedStderr();
  return delivery;
}

TEST(Deliver, ReportsEachIdentityThatDoesNotHoldAndEachDifferenceOfTheFidelities) {
  const Delivery valid = delivery_of({});
  EXPECT_TRUE(valid.all_hold);
  EXPECT_THAT(valid.out, HasSubstr("waits "));
  EXPECT_THAT(valid.err, IsEmpty());
  const Delivery failed =
      delivery_of({"grants = 3: accesses = 4", "stalls = 5: blames = 6"}, {"the fidelities differ: frame 0"});
  EXPECT_FALSE(failed.all_hold);
  EXPECT_EQ(failed.err,
            "stereotlm: error: identity does not hold: grants = 3: accesses = 4\n"
            "stereotlm: error: identity does not hold: stalls = 5: blames = 6\n"
            "stereotlm: error: the fidelities differ: frame 0\n");
  EXPECT_THAT(failed.out, HasSubstr("waits ")) << "the table is printed nevertheless";
  EXPECT_FALSE(delivery_of({"grants = 3: accesses = 4"}).all_hold);
  EXPECT_FALSE(delivery_of({}, {"the fidelities differ: frame 0"}).all_hold);
}

// Whether a run of `frames` frames keeps its truth when it ends after `done` of them, and the note it prints.
std::pair<bool, std::string> truth_after(std::uint64_t done, std::uint64_t frames, std::uint64_t pairs) {
  RunInput input;
  input.frames = frames;
  input.pairs = std::make_unique<PairSource>("--empty", pairs, [](auto) { return host::StereoPair{}; });
  input.truth = media::Truth{};
  input.described.truth = InputFile{"/t.png", "aa"};
  ::testing::internal::CaptureStderr();
  leave_out_truth_of_another_pair(input, done);
  EXPECT_EQ(input.truth.has_value(), input.described.truth.has_value());
  return {input.truth.has_value(), ::testing::internal::GetCapturedStderr()};
}

TEST(TruthOfAnInterruptedRun, StaysOnlyIfTheLastFrameShowsTheSamePair) {
  EXPECT_EQ(truth_after(3, 10, 1), std::pair(true, std::string()));
  EXPECT_EQ(truth_after(6, 10, 4), std::pair(true, std::string()));
  EXPECT_EQ(truth_after(10, 10, 4), std::pair(true, std::string()));
  const std::string note =
      "stereotlm: note: --truth is of the pair of frame 9, which was not reached: no accuracy\n";
  EXPECT_EQ(truth_after(5, 10, 4), std::pair(false, note));
  EXPECT_EQ(truth_after(7, 10, 4), std::pair(false, note));
  EXPECT_EQ(truth_after(9, 10, 10), std::pair(false, note));
}

}  // namespace
}  // namespace stereotlm::runs
