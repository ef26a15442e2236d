#include "models/fpga/conflict_recorder.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "models/fpga/frame_run.h"

namespace stereotlm::fpga {
namespace {

// An image of 8x2 pixels with windows of 3x3, one disparity, a bank for each port. The first table entry is
// read in cycle 0, the first pixel in cycle 2, and the matcher consumes slot i in cycle 4 + i. C is 1: the
// results of four columns leave with their fifth column, each column has 3 slots.
CoreConfig tile_core() {
  CoreConfig config;
  config.width = 8;
  config.height = 2;
  config.window = 3;
  config.disparities = 1;
  config.filter.reset();
  return config;
}

// The end of the fill, and of each group of four columns.
constexpr std::uint64_t kFill = 4 + 3;
constexpr std::uint64_t kGroup = 4 * 3;

class ConflictRecorderTest : public testing::Test {
 protected:
  explicit ConflictRecorderTest(const memory::SsramBankConfig& last_bank = {})
      : banks_({{}, {}, {}, {}, {}, last_bank}) {
    for (std::uint32_t port = 0; port < kCorePortCount; ++port) bases_[port] = registers::base(port, 0);
  }

  // The words of the host are given to the recorder before the frame ends.
  template <class Serve>
  void run_frame(const Serve& serve) {
    frames_.start_direct(frames_.done_cycle(), bases_, patterns_);
    frames_.run_ahead(UINT64_MAX);
    serve();
    frames_.finish();
    frames_.end();
  }
  void run_frame() {
    run_frame([] {});
  }
  std::vector<std::uint64_t> strip_cycles(const FrameConflicts& frame) {
    std::vector<std::uint64_t> cycles;
    for (const StripConflicts& strip : frame.strips) cycles.push_back(strip.cycles);
    return cycles;
  }

  CoreConfig config_ = tile_core();
  std::vector<memory::SsramBankConfig> banks_;
  FrameBases bases_{};
  memory::Arbitration arbitration_{core_arbiter(), banks_};
  FrameRun frames_{config_, banks_, arbitration_, 1000};
  AccessPatterns patterns_{AccessPattern(frames_.control().geometry(), config_.pixel_cache),
                           AccessPattern(frames_.control().geometry(), config_.pixel_cache)};
  ConflictRecorder conflicts_{config_, banks_, {{1000, 2000}}};
};

TEST_F(ConflictRecorderTest, DividesTheCyclesByTheGroupsOfFourColumns) {
  frames_.record(conflicts_);
  run_frame();
  // The last word enters the queue with the last group, and is written in the cycle after it.
  EXPECT_EQ(conflicts_.tile_cycles(),
            (std::vector<std::uint64_t>{kFill, kGroup, kGroup, kGroup, kGroup + 1}));
  const std::vector<FrameConflicts> ended = conflicts_.take_frames();
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(strip_cycles(ended.front()), (std::vector<std::uint64_t>{kFill, 2 * kGroup, 2 * kGroup + 1}));
  EXPECT_TRUE(conflicts_.take_frames().empty());
}

TEST_F(ConflictRecorderTest, CountsTheAccessesOfTheCoreInTheStripOfTheirCycle) {
  frames_.record(conflicts_);
  run_frame();
  const FrameConflicts frame = conflicts_.take_frames().front();
  // In the 7 cycles of the fill the table port takes 7 slots, of which 3 are in the row above the image, and
  // the pixel port handles 5, of which 2 are.
  EXPECT_EQ(frame.accesses[0][0], 4U);
  EXPECT_EQ(frame.accesses[2][0], 3U);
  EXPECT_EQ(frame.accesses[4][0], 0U);
  // Of the words of the first row, one is written in its strip, and one in the first cycle of the next.
  EXPECT_EQ(frame.accesses[frame.banks + 4][0], 1U);
  EXPECT_EQ(frame.accesses[2 * frame.banks + 4][0], 3U);
}

TEST_F(ConflictRecorderTest, SumsTheTilesOverTheFramesButNotTheStrips) {
  frames_.record(conflicts_);
  run_frame();
  run_frame();
  EXPECT_EQ(conflicts_.frames(), 2U);
  EXPECT_EQ(conflicts_.tile_cycles()[0], 2 * kFill);
  EXPECT_EQ(conflicts_.tile_cycles()[4], 2 * (kGroup + 1));
  const std::vector<FrameConflicts> ended = conflicts_.take_frames();
  ASSERT_EQ(ended.size(), 2U);
  EXPECT_EQ(strip_cycles(ended[0]), strip_cycles(ended[1]));
}

TEST_F(ConflictRecorderTest, RecordsNoFrameBeyondThoseWanted) {
  frames_.record(conflicts_);
  conflicts_.record_only(1);
  run_frame();
  run_frame([this] { conflicts_.add_served(HostTraffic::kCapture, 5, frames_.first_cycle(), 1, true); });
  EXPECT_EQ(conflicts_.frames(), 1U);
  EXPECT_EQ(conflicts_.frames_begun(), 2U);
  EXPECT_EQ(conflicts_.tile_cycles()[0], kFill);
}

TEST_F(ConflictRecorderTest, DividesUncontendedWordsOfTheHostAtTheEndsOfStrips) {
  frames_.record(conflicts_);
  run_frame([this] {
    conflicts_.add_served(HostTraffic::kUpload, 5, kFill + 2 * kGroup - 1, 3, true);
    conflicts_.add_served(HostTraffic::kCapture, 5, kFill - 2, 4, true);  // need not be in order
  });
  const FrameConflicts frame = conflicts_.take_frames().front();
  const std::size_t bank = 5;
  EXPECT_EQ(frame.accesses[bank], (FrameConflicts::BankAccesses{0, 2, 0, 0}));
  EXPECT_EQ(frame.accesses[frame.banks + bank], (FrameConflicts::BankAccesses{0, 2, 1, 0}));
  EXPECT_EQ(frame.accesses[2 * frame.banks + bank], (FrameConflicts::BankAccesses{0, 0, 2, 0}));
}

TEST_F(ConflictRecorderTest, KnowsWhatABurstIsFor) {
  EXPECT_EQ(conflicts_.traffic_of(true, 996), HostTraffic::kUpload);
  EXPECT_EQ(conflicts_.traffic_of(true, 1000), HostTraffic::kCapture);
  EXPECT_EQ(conflicts_.traffic_of(true, 1996), HostTraffic::kCapture);
  EXPECT_EQ(conflicts_.traffic_of(true, 2000), HostTraffic::kUpload);
  EXPECT_EQ(conflicts_.traffic_of(false, 1000), HostTraffic::kReadBack);
}

class ConflictRecorderTurnaroundTest : public ConflictRecorderTest {
 protected:
  ConflictRecorderTurnaroundTest() : ConflictRecorderTest({16, memory::BankKind::kSyncBurst, 2, 40}) {}
};

TEST_F(ConflictRecorderTurnaroundTest, BringsUncontendedStallsOfTheHostToTheirTiles) {
  frames_.record(conflicts_);
  run_frame([this] { conflicts_.add_served(HostTraffic::kReadBack, 5, kFill + kGroup - 1, 2, false); });
  ASSERT_EQ(conflicts_.stalls().size(), 1U);
  const ConflictRecorder::Stalls& stalls = *conflicts_.stalls().front();
  EXPECT_EQ(stalls.requester, requester_of(HostTraffic::kReadBack));
  EXPECT_EQ(stalls.bank, 5U);
  EXPECT_EQ(stalls.by, kTurnaroundToBlame);
  EXPECT_EQ(stalls.cycles, (std::vector<std::uint64_t>{0, 1, 1, 0, 0}));
  EXPECT_EQ(conflicts_.take_frames().front().strips[1].stalls[requester_of(HostTraffic::kReadBack)], 2U);
}

// Frames beside bursts of the host that write to the bank of the left table, 5 words each.
class BurstsOfHost {
 public:
  BurstsOfHost() {
    for (std::uint32_t port = 0; port < kCorePortCount; ++port) bases_[port] = registers::base(port, 0);
    frames_.record(conflicts_);
  }
  void start() { frames_.start_direct(frames_.done_cycle(), bases_, patterns_); }
  bool done() const { return frames_.control().frame_done(); }
  std::uint64_t cycle() const { return frames_.cycle(); }
  // Both return the cycle of the last grant.
  std::uint64_t serve_at_once(std::uint64_t first, HostTraffic traffic) {
    std::uint64_t last_grant = first;
    for (std::size_t left = kWords; left != 0 && !done();) {
      const FastForward::Served served = frames_.serve_host({0, true, traffic}, first, left);
      left -= served.words;
      if (served.words != 0) last_grant = served.last_cycle;
      first = last_grant + 1;
    }
    return last_grant;
  }
  std::uint64_t serve_in_steps(std::uint64_t first, HostTraffic traffic) {
    while (cycle() < first && !done()) frames_.step(false);
    if (done()) return first;
    conflicts_.set_host_traffic(traffic);
    frames_.host_route_changes();
    arbitration_.route(kHostPort, 0, true);
    std::uint64_t last_grant = first;
    for (std::size_t left = kWords; left != 0 && !done();) {
      if ((frames_.step(true) & memory::mask_of(kHostPort)) == 0) continue;
      last_grant = cycle() - 1;
      --left;
    }
    frames_.host_route_changes();
    arbitration_.unroute(kHostPort);
    return last_grant;
  }
  void finish() {
    frames_.run_ahead(UINT64_MAX);
    frames_.finish();
    frames_.end();
  }
  std::uint64_t skipped_cycles() const { return frames_.skipped_cycles(); }

  // All that has been recorded.
  std::vector<std::uint64_t> figures() {
    std::vector<std::uint64_t> figures = conflicts_.tile_cycles();
    for (const ConflictRecorder::Stalls* stalls : conflicts_.stalls()) {
      figures.insert(figures.end(), {stalls->requester, stalls->bank, stalls->by});
      figures.insert(figures.end(), stalls->cycles.begin(), stalls->cycles.end());
    }
    for (const FrameConflicts& frame : conflicts_.take_frames()) {
      for (const StripConflicts& strip : frame.strips) {
        figures.push_back(strip.cycles);
        figures.insert(figures.end(), strip.stalls.begin(), strip.stalls.end());
      }
      for (const FrameConflicts::BankAccesses& bank : frame.accesses)
        figures.insert(figures.end(), bank.begin(), bank.end());
    }
    return figures;
  }

 private:
  static constexpr std::size_t kWords = 5;

  static CoreConfig core() {
    CoreConfig config = tile_core();
    config.width = 64;
    config.height = 24;
    return config;
  }

  CoreConfig config_ = core();
  std::vector<memory::SsramBankConfig> banks_ = std::vector<memory::SsramBankConfig>(6);
  FrameBases bases_{};
  memory::Arbitration arbitration_{core_arbiter(), banks_};
  FrameRun frames_{config_, banks_, arbitration_, 1000};
  AccessPatterns patterns_{AccessPattern(frames_.control().geometry(), config_.pixel_cache),
                           AccessPattern(frames_.control().geometry(), config_.pixel_cache)};
  ConflictRecorder conflicts_{config_, banks_, {}};
};

// They begin in every phase of a group, some in the same group, and some lie across the end of a strip.
TEST(ConflictRecorder, RecordsBurstsThatAreSkippedAsTheirSteps) {
  for (const std::uint64_t pause : {1U, 3U, 7U, 31U, 60U, 191U}) {
    SCOPED_TRACE(pause);
    BurstsOfHost at_once;
    BurstsOfHost in_steps;
    for (int frame = 0; frame < 3; ++frame) {
      at_once.start();
      in_steps.start();
      HostTraffic traffic = HostTraffic::kCapture;
      for (std::uint64_t first = in_steps.cycle() + 50; !in_steps.done();) {
        const std::uint64_t last_grant = in_steps.serve_in_steps(first, traffic);
        ASSERT_EQ(at_once.serve_at_once(first, traffic), last_grant);
        traffic = traffic == HostTraffic::kCapture ? HostTraffic::kUpload : HostTraffic::kCapture;
        first = last_grant + 1 + pause;
      }
      at_once.finish();
      in_steps.finish();
      ASSERT_EQ(at_once.figures(), in_steps.figures()) << frame;
    }
    EXPECT_GT(at_once.skipped_cycles(), 8000U);  // of 3 frames with 4600 cycles
    EXPECT_EQ(in_steps.skipped_cycles(), 0U);
  }
}

TEST(TileGrid, HasATileForEachGroupUpToTheMost) {
  CoreConfig config;
  config.width = 64;
  config.height = 48;
  const FrameGeometry geometry(config);
  const TileGrid whole(geometry, 16 * 48);
  EXPECT_EQ(whole.columns * whole.rows, 16U * 48U);
  EXPECT_EQ(whole.columns_of_tile, 4U);
  EXPECT_EQ(whole.rows_of_tile, 1U);
  const TileGrid larger(geometry, 16 * 48 - 1);
  EXPECT_EQ(larger.columns, 16U);
  EXPECT_EQ(larger.rows, 24U);
  EXPECT_EQ(larger.rows_of_tile, 2U);
  const TileGrid one(geometry, 1);
  EXPECT_EQ(one.columns * one.rows, 1U);
  EXPECT_GE(one.columns_of_tile, 64U);
}

TEST(TileGrid, MakesTilesOfRowsThatLeaveAtOnce) {
  CoreConfig config;
  config.width = 64;
  config.height = 45;
  config.rows = 8;
  const TileGrid grid(FrameGeometry(config), 48);
  EXPECT_EQ(grid.rows_of_tile, 8U);
  EXPECT_EQ(grid.rows, 6U);
  EXPECT_EQ(grid.columns, 8U);  // 8 pixels wide, as high
}

}  // namespace
}  // namespace stereotlm::fpga
