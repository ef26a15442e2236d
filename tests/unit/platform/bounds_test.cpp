#include "platform/bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

using std::uint64_t;
using testing::PreloadedRun;
using testing::small_board;

std::optional<uint64_t> bound_of(const BoardConfig& board, const Tables& tables, const std::string& resource,
                                 uint64_t frame = 0) {
  for (const ResourceBound& bound : frame_bounds(board, tables, frame)) {
    if (bound.resource == resource) return bound.cycles;
  }
  return std::nullopt;
}
std::optional<uint64_t> bound_of(const BoardConfig& board, const std::string& resource, uint64_t frame = 0) {
  return bound_of(board, identity_tables(board), resource, frame);
}

uint64_t largest(const BoardConfig& board, const Tables& tables, uint64_t frame) {
  uint64_t cycles = 0;
  for (const ResourceBound& bound : frame_bounds(board, tables, frame))
    cycles = std::max(cycles, bound.cycles);
  return cycles;
}

// small_board(): slots of 16 columns of 6 rows, 3 each; two of the 18 row fetches lie outside the image. The
// drain has D - 1 + r columns.
constexpr uint64_t kSlots = uint64_t{16} * 6 * 3;
constexpr uint64_t kReads = uint64_t{16} * (6 * 3 - 2);
constexpr uint64_t kDrain = uint64_t{3} * (3 - 1 + 1);
constexpr uint64_t kWords = 16 * 6 / 4;
constexpr uint64_t kPipeline = 16;
constexpr uint64_t kAfter = kDrain + 1 + kPipeline;

TEST(FrameBounds, ListPortsThenBanksThenTheMatcher) {
  const BoardConfig board = small_board();
  std::vector<std::string> names;
  for (const ResourceBound& bound : frame_bounds(board, identity_tables(board), 1))
    names.push_back(bound.resource);
  EXPECT_EQ(names, (std::vector<std::string>{"port left_lut", "port right_lut", "port left_pixel",
                                             "port right_pixel", "port result", "bank bank1", "bank bank3",
                                             "bank bank5", "bank bank6", "bank bank7", "matcher"}));
}

TEST(FrameBounds, GiveAPortOneSlotOrWordACycle) {
  const BoardConfig board = small_board();
  for (const char* port : {"port left_lut", "port right_lut", "port left_pixel", "port right_pixel"})
    EXPECT_EQ(bound_of(board, port), kSlots + kPipeline) << port;
  EXPECT_EQ(bound_of(board, "port result"), kWords + kPipeline);
}

TEST(FrameBounds, GiveABankItsReadsAndWhatFollowsTheLastOfThem) {
  BoardConfig board = small_board();
  EXPECT_EQ(bound_of(board, "bank bank0"), kReads + 2 + kAfter);
  EXPECT_EQ(bound_of(board, "bank bank6"), kReads + 4 + kAfter);
  EXPECT_EQ(bound_of(board, "bank bank4"), kWords + kPipeline);
  EXPECT_EQ(bound_of(board, "bank bank1"), std::nullopt);  // of the other half
  EXPECT_EQ(bound_of(board, "bank bank1", 1), kReads + 2 + kAfter);
  board.banks[0].kind = memory::BankKind::kZbtFlowThrough;
  EXPECT_EQ(bound_of(board, "bank bank0"), kReads + 1 + kAfter);
  EXPECT_EQ(bound_of(board, "bank bank6"), kReads + 3 + kAfter);
}

TEST(FrameBounds, AddUpTheAccessesThatShareABank) {
  BoardConfig board = small_board();
  board.allocation.left_lut = "bank0";
  EXPECT_EQ(bound_of(board, "bank bank0"), 2 * kReads + 2 + kAfter);
  board.allocation.right_lut = "bank0";
  EXPECT_EQ(bound_of(board, "bank bank0"), 3 * kReads + 2 + kAfter);
  board.allocation.disparity = {"bank0"};
  // More writes than what follows the last read: all accesses count.
  EXPECT_EQ(bound_of(board, "bank bank0"),
            std::max(3 * kReads + 2 + kAfter, 3 * kReads + kWords + kPipeline));
  EXPECT_GT(3 * kReads + kWords + kPipeline, 3 * kReads + 2 + kAfter);
}

TEST(FrameBounds, CountTheReadsOfLineBuffers) {
  BoardConfig board = small_board();
  board.matcher.fetch = fpga::Fetch::kLineBuffer;
  const uint64_t after = (3 - 1 + 1) + 1 + kPipeline;
  EXPECT_EQ(bound_of(board, "port left_lut"), uint64_t{16} * 7 + kPipeline);
  EXPECT_EQ(bound_of(board, "bank bank0"), 16 * 6 + 2 + after);
  EXPECT_EQ(bound_of(board, "matcher"), 4 + 16 * 7 + after);
}

TEST(FrameBounds, CountTheReadsOfALargeFilter) {
  BoardConfig board = small_board();
  board.matcher.filter = kernels::log7();  // two strips more, rows 0..5 of -2+3-1 = 0 on
  const uint64_t drain = uint64_t{3} * (3 - 1 + 1 + 3);
  EXPECT_EQ(bound_of(board, "matcher"), 4 + 16 * 8 * 3 + drain + 1 + kPipeline);
  // Strips start at rows 0 .. 7: six rows of three, less those below the image.
  EXPECT_EQ(bound_of(board, "bank bank0"), 16 * (4 * 3 + 2 + 1) + 2 + drain + 1 + kPipeline);
  board.matcher.fetch = fpga::Fetch::kLineBuffer;
  EXPECT_EQ(bound_of(board, "matcher"), 4 + 16 * (6 + 1 + 3) + (3 - 1 + 1 + 3) + 1 + kPipeline);
}

TEST(FrameBounds, LeaveOutThePixelsOfEntriesThatAreNotValid) {
  const BoardConfig board = small_board();
  Tables tables = identity_tables(board);
  tables.left->entries[0] = 0;           // row 0 is fetched twice,
  tables.left->entries[16 * 3 + 5] = 0;  // row 3 three times
  EXPECT_EQ(bound_of(board, tables, "bank bank0"), kReads - 2 - 3 + 2 + kAfter);
  EXPECT_EQ(bound_of(board, tables, "bank bank6"), kReads + 4 + kAfter);
  EXPECT_EQ(bound_of(board, tables, "bank bank2"), kReads + 2 + kAfter);
  for (std::uint32_t& entry : tables.left->entries) entry = 0;
  EXPECT_EQ(bound_of(board, tables, "bank bank0"), std::nullopt);
}

TEST(FrameBounds, KnowNoTableThatDoesNotExist) {
  BoardConfig board = small_board();
  board.allocation.left_lut.reset();
  EXPECT_EQ(bound_of(board, "port left_lut"), std::nullopt);
  EXPECT_EQ(bound_of(board, "bank bank6"), std::nullopt);
  EXPECT_EQ(bound_of(board, "bank bank0"), kReads + 2 + kAfter);
  EXPECT_EQ(bound_of(board, "matcher"), 4 + kSlots + kAfter);
  board.allocation.right_lut.reset();
  EXPECT_EQ(bound_of(board, "matcher"), 2 + kSlots + kAfter);
}

// A slot stays for the latencies and the cycle in which it is consumed: 2 + 2 + 1 cycles with a table.
TEST(FrameBounds, GiveThePortThatTakesSlotsThePlacesOfTheLaneForAsLongAsASlotStays) {
  BoardConfig board = small_board();
  for (const int places : {1, 2, 4, 5, 6, 64}) {
    board.fpga.lane_fifo_slots = places;
    const uint64_t rounds = (kSlots - 1) / static_cast<uint64_t>(places);
    const uint64_t expected = std::max(kSlots + kPipeline, rounds * 5 + 5 + kAfter);
    EXPECT_EQ(expected > kSlots + kPipeline, places < 6) << "both sides of the gate";
    EXPECT_EQ(bound_of(board, "port left_lut"), expected) << places;
    EXPECT_EQ(bound_of(board, "port right_lut"), expected) << places;
    EXPECT_EQ(bound_of(board, "port left_pixel"), kSlots + kPipeline) << places;
  }
}

TEST(FrameBounds, GiveThePixelPortThePlacesOfTheLaneWhereThereIsNoTable) {
  BoardConfig board = small_board();
  board.allocation.left_lut.reset();
  board.fpga.lane_fifo_slots = 2;
  const uint64_t rounds = (kSlots - 1) / 2;
  EXPECT_EQ(bound_of(board, "port left_pixel"), rounds * 3 + 3 + kAfter);
  EXPECT_EQ(bound_of(board, "port right_pixel"), kSlots + kPipeline);
  EXPECT_EQ(bound_of(board, "port right_lut"), rounds * 5 + 5 + kAfter);
}

TEST(FrameBounds, RefuseABoardWithProblems) {
  BoardConfig board = small_board();
  board.matcher.window = 4;
  EXPECT_THROW(frame_bounds(board, Tables{}, 0), std::invalid_argument);
}

TEST(CoreBound, RepeatsWithTheLeastCommonMultipleOfTheLists) {
  BoardConfig board = small_board();
  EXPECT_EQ(allocation_period_frames(board), 2U);
  board.allocation.disparity = {"bank4", "bank5", "bank4"};
  EXPECT_EQ(allocation_period_frames(board), 6U);
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank1"};
  EXPECT_EQ(allocation_period_frames(board), 3U);
}

TEST(CoreBound, RefusesABoardWithProblemsAndNoFrames) {
  BoardConfig board = small_board();
  EXPECT_THROW(core_bound(board, identity_tables(board), 0), std::invalid_argument);
  EXPECT_NO_THROW(core_bound(board, identity_tables(board), 1));
  board.matcher.window = 4;
  EXPECT_THROW(core_bound(board, Tables{}, 1), std::invalid_argument);
  board = small_board();
  board.allocation.disparity.clear();
  EXPECT_THROW(core_bound(board, identity_tables(board), 1), std::invalid_argument);
}

TEST(CoreBound, SumsTheFramesOfTheListsInTurn) {
  BoardConfig board = small_board();
  board.allocation.left_lut = "bank1";  // meets the left image in every other frame
  const Tables tables = identity_tables(board);
  const uint64_t first = largest(board, tables, 0);
  const uint64_t second = largest(board, tables, 1);
  EXPECT_EQ(first, 4 + kSlots + kAfter);
  EXPECT_EQ(second, 2 * kReads + 2 + kAfter);
  const std::map<uint64_t, uint64_t> cycles = {
      {1, first}, {2, first + second}, {3, 2 * first + second}, {4, 2 * (first + second)}};
  for (const auto& [frames, total] : cycles) {
    const Bound bound = core_bound(board, tables, frames);
    EXPECT_DOUBLE_EQ(bound.core, 40e6 * static_cast<double>(frames) / static_cast<double>(total)) << frames;
    EXPECT_EQ(bound.core_limited_by, frames == 1 ? "matcher" : "bank bank1") << frames;
  }
}

TEST(CoreBound, NamesTheLastOfEqualResources) {
  BoardConfig board = small_board();
  board.allocation.left_lut = "bank0";
  board.allocation.right_lut = "bank2";
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  EXPECT_EQ(bound_of(board, "bank bank0"), bound_of(board, "bank bank2"));
  EXPECT_EQ(core_bound(board, identity_tables(board), 1).core_limited_by, "bank bank2");
}

// Boards by name, so that each runs in a process of its own.
struct Case {
  BoardConfig board;
  Tables tables;
};

Case board_case(const std::string& name) {
  BoardConfig board = small_board();
  auto& matcher = board.matcher;
  auto& allocation = board.allocation;
  const auto all_kinds = [&board](memory::BankKind kind, int turnaround) {
    for (BankConfig& bank : board.banks) bank.kind = kind, bank.turnaround_cycles = turnaround;
  };
  bool holes = false;
  if (name == "line_buffer") matcher.fetch = fpga::Fetch::kLineBuffer;
  if (name == "log7") matcher.filter = kernels::log7(), matcher.window = 5;
  if (name == "large_filter") matcher.filter = kernels::log7();
  if (name == "large_filter_line_buffer")
    matcher.filter = kernels::log7(), matcher.fetch = fpga::Fetch::kLineBuffer;
  if (name == "flow_through") all_kinds(memory::BankKind::kZbtFlowThrough, 0);
  if (name == "one_slow_bank") {
    all_kinds(memory::BankKind::kZbtFlowThrough, 0);
    board.banks[7].kind = memory::BankKind::kZbtPipelined;
  }
  if (name == "no_tables") allocation.left_lut.reset(), allocation.right_lut.reset();
  if (name == "no_left_table") allocation.left_lut.reset();
  if (name == "one_row") board.image = {16, 1};
  if (name == "window_larger_than_image") matcher.window = 31, matcher.disparities = 40;
  if (name == "no_pipeline") board.fpga.pipeline_latency_cycles = 0;
  if (name == "one_place") board.fpga.lane_fifo_slots = 1;
  if (name == "five_places") board.fpga.lane_fifo_slots = 5;
  if (name == "holes") holes = true;
  // Contended.
  if (name == "table_with_image") allocation.left_lut = "bank0";
  if (name == "table_with_image_and_holes") allocation.left_lut = "bank0", holes = true;
  if (name == "result_with_image") allocation.disparity = {"bank0", "bank0"};
  if (name == "round_robin") {
    board.fpga.arbiter.policy = "round_robin";
    allocation.left_lut = "bank0", allocation.right_lut = "bank0",
    allocation.right_image = {"bank0", "bank1"};
  }
  if (name == "one_bank") {
    allocation = {{"bank0"}, {"bank0"}, {"bank0"}, "bank0", "bank0"};
  }
  if (name == "sync_burst") {
    all_kinds(memory::BankKind::kSyncBurst, 2);
    allocation = {{"bank0"}, {"bank1"}, {"bank0"}, "bank2", "bank3"};
  }
  if (name == "one_result_word") board.fpga.result_fifo_words = 1, matcher.fetch = fpga::Fetch::kLineBuffer;
  if (name == "two_places") board.fpga.lane_fifo_slots = 2;
  if (name == "four_places") board.fpga.lane_fifo_slots = 4;
  if (name == "ping_pong") allocation.left_lut = "bank1";
  Tables tables = identity_tables(board);
  for (std::size_t entry = 0; holes && entry < tables.left->entries.size(); entry += 3)
    tables.left->entries[entry] = 0;
  return {board, tables};
}

constexpr uint64_t kFrames = 3;

class UncontendedBoards : public ::testing::TestWithParam<const char*> {};

TEST_P(UncontendedBoards, TakeExactlyTheirBound) {
  const Case named = board_case(GetParam());
  PreloadedRun run(named.board, named.tables, kFrames);
  const Statistics statistics = run.finish();
  ASSERT_EQ(statistics.frame_cycles.size(), kFrames);
  for (uint64_t frame = 0; frame < kFrames; ++frame)
    EXPECT_EQ(statistics.frame_cycles[frame], largest(named.board, named.tables, frame));
  EXPECT_EQ(statistics.frames_per_second.core, core_bound(named.board, named.tables, kFrames).core);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Bounds, UncontendedBoards,
                         ::testing::Values("paper", "line_buffer", "log7", "large_filter",
                                           "large_filter_line_buffer", "flow_through", "one_slow_bank",
                                           "no_tables", "no_left_table", "one_row",
                                           "window_larger_than_image", "no_pipeline", "one_place",
                                           "five_places", "holes"));

class ContendedBoards : public ::testing::TestWithParam<const char*> {};

TEST_P(ContendedBoards, TakeLongerThanTheirBound) {
  const Case named = board_case(GetParam());
  PreloadedRun run(named.board, named.tables, kFrames);
  const Statistics statistics = run.finish();
  ASSERT_EQ(statistics.frame_cycles.size(), kFrames);
  uint64_t measured = 0;
  uint64_t bound = 0;
  for (uint64_t frame = 0; frame < kFrames; ++frame) {
    EXPECT_GE(statistics.frame_cycles[frame], largest(named.board, named.tables, frame));
    measured += statistics.frame_cycles[frame];
    bound += largest(named.board, named.tables, frame);
  }
  EXPECT_GT(measured, bound);
  EXPECT_LT(statistics.frames_per_second.core, core_bound(named.board, named.tables, kFrames).core);
  EXPECT_EQ(statistics.failed, std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Bounds, ContendedBoards,
                         ::testing::Values("table_with_image", "table_with_image_and_holes",
                                           "result_with_image", "round_robin", "one_bank", "sync_burst",
                                           "one_result_word", "ping_pong"));

class FewPlaces : public ::testing::TestWithParam<const char*> {};

TEST_P(FewPlaces, TakeLessThanARoundLongerThanTheirBound) {
  const Case named = board_case(GetParam());
  PreloadedRun run(named.board, named.tables, 1);
  const Statistics statistics = run.finish();
  const uint64_t bound = largest(named.board, named.tables, 0);
  EXPECT_EQ(core_bound(named.board, named.tables, 1).core_limited_by, "port right_lut");
  EXPECT_GE(statistics.frame_cycles.at(0), bound);
  EXPECT_LT(statistics.frame_cycles.at(0), bound + static_cast<uint64_t>(named.board.fpga.lane_fifo_slots));
}

INSTANTIATE_TEST_SUITE_P(Bounds, FewPlaces, ::testing::Values("one_place", "two_places", "four_places"));

// 40 MHz: a cycle takes 25 ns.
constexpr double kCycle = 25e-9;

TEST(LeastDelivery, IsWhenTheFramesAreDoneOneAfterAnother) {
  const BoardConfig board = small_board();
  const Tables tables = identity_tables(board);
  const auto cycles = static_cast<double>(2 * largest(board, tables, 0) + largest(board, tables, 1));
  EXPECT_NEAR(least_delivery_s(board, frame_accesses(board, tables), 3, {0, 0.5}), 0.5 + cycles * kCycle,
              1e-12);
  EXPECT_NEAR(least_delivery_s(board, frame_accesses(board, tables), 5, {2, 1.5}), 1.5 + cycles * kCycle,
              1e-12);
}

// Of 100 frames, or the last 10 of them: what the core reads and writes, results read back, and all pairs but
// the first.
TEST(LeastDelivery, CountsWhatTheHostMovesInABank) {
  BoardConfig board = small_board();
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  board.allocation.disparity = {"bank0"};
  const Tables tables = identity_tables(board);
  for (const uint64_t from : {uint64_t{0}, uint64_t{90}}) {
    const uint64_t frames = 100 - from;
    const uint64_t cycles = frames * (kReads + 2 * kWords) + (frames - 1) * kWords;
    ASSERT_GT(cycles, frames * largest(board, tables, 0));
    EXPECT_NEAR(least_delivery_s(board, frame_accesses(board, tables), 100, {from, 0.25}),
                0.25 + static_cast<double>(cycles) * kCycle, 1e-12);
  }
}

}  // namespace
}  // namespace stereotlm::platform
