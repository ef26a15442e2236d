// The bursts of a capture board on the PCI bus.
#include <ostream>

#include "tests/support/expected_report.h"
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

using pci::BurstEnd;
using test::BusTurn;

class CaptureBurst : public CaptureBench {
 protected:
  CaptureBoard::Stats stats() const { return side->board.stats(); }
  std::vector<std::uint8_t> captured() const { return side->buffer(kAddress, 0); }
  std::vector<std::uint8_t> sent() const { return side->source.picture(0).pixels; }
  static BusTurn cut(std::size_t words, BurstEnd end) {
    BusTurn turn;
    turn.limit = words;
    turn.cut = end;
    return turn;
  }
};

TEST_F(CaptureBurst, WritesTheFrameRowByRowWithTheLowestColumnInTheLowestByte) {
  build_and_arm();
  run_frame();
  EXPECT_EQ(captured(), sent());
  EXPECT_EQ(burst(0).words.at(0),
            sent()[0] | unsigned{sent()[1]} << 8U | unsigned{sent()[2]} << 16U | unsigned{sent()[3]} << 24U);
  EXPECT_EQ(side->bus.memory.size(), 12U);
  EXPECT_EQ(stats().words, 12U);
  EXPECT_EQ(stats().bursts, side->bus.bursts.size());
  EXPECT_EQ(stats().dropped_pixels, 0U);
  EXPECT_EQ(stats().captured_frames, 1U);
}

TEST_F(CaptureBurst, RequestsTheBusAtItsTriggerAndAtTheEndOfALine) {
  board = {4, 3};
  build_and_arm();
  run_frame();
  ASSERT_EQ(side->bus.requests_ps.size(), 6U);
  for (int row = 0; row < 3; ++row) {
    const auto first = 2 * static_cast<std::size_t>(row);
    EXPECT_EQ(side->bus.requests_ps[first], word_ps(2, row));
    EXPECT_EQ(side->bus.requests_ps[first + 1], word_ps(3, row));
    EXPECT_EQ(burst(first).address, kAddress + 16U * static_cast<unsigned>(row));
    EXPECT_EQ(burst(first).words.size(), 3U);
    EXPECT_EQ(burst(first + 1).address, kAddress + 16U * static_cast<unsigned>(row) + 12U);
    EXPECT_EQ(burst(first + 1).words.size(), 1U);
  }
}

// The first burst is granted the first clock that begins at or after a word is complete, or one before.
struct Grant {
  int fifo_words;
  int word;
  int row;
  std::uint64_t clocks_before;
  std::size_t words;  // expected length of the burst
};

class CaptureGrant : public CaptureBurst, public testing::WithParamInterface<Grant> {};

TEST_P(CaptureGrant, TakesTheWordsThatAreCompleteAsItsClockBegins) {
  const Grant& grant = GetParam();
  board = {grant.fifo_words, 1};
  build_and_arm();
  grant_in(0, edge_at_or_after(word_ps(grant.word, grant.row)) - grant.clocks_before);
  run_frame();
  EXPECT_EQ(burst(0).words.size(), grant.words);
  EXPECT_EQ(burst(1).address, kAddress + 4 * grant.words);
  if (grant.clocks_before == 1) {
    EXPECT_EQ(side->bus.requests_ps[1], burst(0).end_ps);  // the word has come meanwhile
  }
  EXPECT_EQ(captured(), sent());
}

INSTANTIATE_TEST_SUITE_P(Words, CaptureGrant,
                         testing::Values(Grant{4, 2, 0, 0, 3}, Grant{4, 2, 0, 1, 2}, Grant{12, 1, 2, 0, 10}),
                         [](const auto& tested) { return std::to_string(tested.param.words); });

// Edges are at whole ns. The frame rate is one at which word 1 is complete some ps after an edge.
class CaptureGrantEdge : public CaptureBurst, public testing::WithParamInterface<std::uint64_t> {};

TEST_P(CaptureGrantEdge, TakesAWordThatIsCompleteAtTheEdgeButNotAPsLater) {
  const std::uint64_t late_ps = GetParam();
  board = {4, 1};
  clock_mhz = 1000;
  for (int i = 0; i < 100'000 && CameraTiming(camera).pixel_ps(7, 0) % 1000 != late_ps; ++i)
    camera.frame_rate_hz = (10'000 + i) / 100.0;
  build_and_arm();
  grant_in(0, word_ps(1, 0) / 1000);
  run_frame();
  EXPECT_EQ(burst(0).address_clock_ps, word_ps(1, 0) - late_ps);
  EXPECT_EQ(burst(0).words.size(), 2 - late_ps);
  EXPECT_EQ(captured(), sent());
}

INSTANTIATE_TEST_SUITE_P(LatePs, CaptureGrantEdge, testing::Values(0U, 1U));

// The first `bursts` bursts transfer `words` words each.
struct Cuts {
  const char* name;
  std::size_t bursts;
  std::size_t words;
  BurstEnd end;
};
void PrintTo(const Cuts& cuts, std::ostream* out) { *out << cuts.name; }

class CaptureCut : public CaptureBurst, public testing::WithParamInterface<Cuts> {};

TEST_P(CaptureCut, IsFollowedAtOnceByARequestForTheRest) {
  const Cuts& cuts = GetParam();
  board = {4, 3};
  build_and_arm();
  side->bus.plan = [&](std::size_t request) {
    return request < cuts.bursts ? cut(cuts.words, cuts.end) : BusTurn{};
  };
  run_frame();
  for (std::size_t i = 0; i < cuts.bursts; ++i) {
    EXPECT_EQ(burst(i).result.words, cuts.words);
    EXPECT_EQ(side->bus.requests_ps[i + 1], burst(i).end_ps);
  }
  EXPECT_EQ(burst(cuts.bursts).address, kAddress + 4 * cuts.bursts * cuts.words);
  EXPECT_EQ(burst(cuts.bursts).words.size(), 3 - cuts.bursts * cuts.words);
  EXPECT_EQ(captured(), sent());
  EXPECT_EQ(stats().words, 12U);
  EXPECT_EQ(stats().captured_frames, 1U);
}

INSTANTIATE_TEST_SUITE_P(Ends, CaptureCut,
                         testing::Values(Cuts{"by_the_latency_timer", 1, 2, BurstEnd::kLatencyTimer},
                                         Cuts{"by_disconnects", 2, 1, BurstEnd::kDisconnect},
                                         Cuts{"by_retries", 2, 0, BurstEnd::kDisconnect},
                                         Cuts{"by_many_retries", 1000, 0, BurstEnd::kDisconnect}),
                         [](const auto& tested) { return tested.param.name; });

class CaptureBusError : public CaptureBurst, public testing::WithParamInterface<BurstEnd> {};

TEST_P(CaptureBusError, LosesTheWordsOfTheBurstAndContinuesTheCapture) {
  build_and_arm();
  plan(1, cut(0, GetParam()));
  run_to(word_ps(3, 0));
  run_to(Clock::now_ps() + 60'000);  // in the burst
  ASSERT_EQ(side->bus.bursts.size(), 2U);
  run_to(burst(1).end_ps - 1);
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  run_to(burst(1).end_ps);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), registers::kStatusCapturing | registers::kStatusWordsLost);
  side->write(registers::kStatus, registers::kStatusWordsLost);
  run_to(Clock::now_ps());
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
  side->bus.plan = [](std::size_t) { return cut(0, GetParam()); };
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
  EXPECT_THROW(side->bus.master().begin_burst(Clock::now_ps()), sc_core::sc_report);
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
