// The bursts of a capture board on the PCI bus. capture_random_test.cpp compares their times, words and ends
// with those of the literal board.
#include "models/testing/expected_report.h"
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

using pci::BurstEnd;

class CaptureBurst : public CaptureBench {
 protected:
  CaptureBoard::Stats stats() const { return side->board.stats(); }
  std::vector<std::uint8_t> captured() const { return side->buffer(kAddress, 0); }
  std::vector<std::uint8_t> sent() const { return side->source.picture(0).pixels; }
  // The burst transfers nothing.
  static test::BusTurn lost(BurstEnd end) {
    test::BusTurn turn;
    turn.limit = 0;
    turn.cut = end;
    return turn;
  }
};

class CaptureBusError : public CaptureBurst, public testing::WithParamInterface<BurstEnd> {};

TEST_P(CaptureBusError, LosesTheWordsOfTheBurstAndContinuesTheCapture) {
  build_and_arm();
  plan(1, lost(GetParam()));
  run_to(word_ps(3, 0));
  run_to(kernel_time::now_ps() + 60'000);  // in the burst
  ASSERT_EQ(side->bus.bursts.size(), 2U);
  run_to(burst(1).end_ps - 1);
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  run_to(burst(1).end_ps);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), registers::kStatusCapturing | registers::kStatusWordsLost);
  side->write(registers::kStatus, registers::kStatusWordsLost);
  run_to(kernel_time::now_ps());
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  run_frame();
  EXPECT_EQ(side->status(), registers::kStatusDone);
  EXPECT_EQ(stats().bus_errors, 1U);
  EXPECT_EQ(stats().lost_words, 2U);
  EXPECT_EQ(stats().words, 10U);
  EXPECT_EQ(side->host.read(registers::kLostWords).word, 2U);
  std::vector<std::uint8_t> expected = sent();
  std::fill(expected.begin() + 8, expected.begin() + 16, std::uint8_t{0});
  EXPECT_EQ(captured(), expected);
}

TEST_P(CaptureBusError, EndsTheCaptureIfTheLastWordsAreLost) {
  build_and_arm();
  side->bus.plan = [](std::size_t) { return lost(GetParam()); };
  run_frame();
  EXPECT_EQ(side->status(), registers::kStatusDone | registers::kStatusWordsLost);
  EXPECT_EQ(side->board.last_capture()->end_ps, side->bus.bursts.back().end_ps);
  EXPECT_EQ(side->board.last_capture()->lost_words, 12U);
  EXPECT_EQ(stats().words, 0U);
  side->arm(kAddress);
  side->bus.plan = nullptr;
  run_to(side->camera.timing().frame_ps(2) - 1);
  EXPECT_EQ(side->board.last_capture()->lost_words, 0U);
  EXPECT_EQ(stats().lost_words, 12U);
}

INSTANTIATE_TEST_SUITE_P(Ends, CaptureBusError,
                         testing::Values(BurstEnd::kMasterAbort, BurstEnd::kTargetError),
                         [](const auto& end) {
                           return end.param == BurstEnd::kMasterAbort ? "MasterAbort" : "TargetError";
                         });

TEST_F(CaptureBurst, ReportsAGrantBeforeItsRequestOrWithoutOne) {
  build_and_arm();
  side->bus.turn.busy_clocks = 10;
  run_to(word_ps(1, 0));
  ASSERT_EQ(side->bus.requests_ps.size(), 1U);
  test::ExpectedReport expected("/stereotlm/capture_board", 2);
  EXPECT_THROW(side->bus.master().begin_burst(word_ps(1, 0) - 1), sc_core::sc_report);
  EXPECT_EQ(expected.text(), "board: bus granted at " + std::to_string(word_ps(1, 0) - 1) +
                                 " ps: must have been requested by then");
  run_to(word_ps(3, 0) + 1'000'000);
  EXPECT_THROW(side->bus.master().begin_burst(kernel_time::now_ps()), sc_core::sc_report);
}

TEST_F(CaptureBurst, ReportsTheEndOfABurstThatDoesNotRunOrCannotEndSo) {
  build_and_arm();
  side->bus.turn.wait_clocks = 1'000;
  const pci::BurstResult wrong[] = {
      {BurstEnd::kComplete, 1, 0},     {BurstEnd::kComplete, 3, 0},   {BurstEnd::kLatencyTimer, 2, 0},
      {BurstEnd::kLatencyTimer, 0, 0}, {BurstEnd::kDisconnect, 2, 0}, {BurstEnd::kMasterAbort, 1, 0},
      {BurstEnd::kTargetError, 2, 0},
  };
  test::ExpectedReport expected("/stereotlm/capture_board", 1 + static_cast<int>(std::size(wrong)));
  run_to(word_ps(1, 0));  // the bus is requested and not yet granted
  pci::PciMasterIf& master = side->bus.master();
  EXPECT_THROW(master.end_burst({BurstEnd::kDisconnect, 0, 0}), sc_core::sc_report);
  run_to(word_ps(1, 0) + 100'000);
  ASSERT_EQ(burst(0).words.size(), 2U);
  for (const pci::BurstResult& result : wrong) EXPECT_THROW(master.end_burst(result), sc_core::sc_report);
}

}  // namespace
}  // namespace stereotlm::capture
