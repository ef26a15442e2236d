#include "platform/figures/bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <ostream>

#include "models/capture/camera_timing.h"
#include "platform/figures/search_bounds.h"
#include "platform/loop/core_loop.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

using std::uint64_t;
using testing::kPipeline;
using testing::PreloadedRun;
using testing::small_board;

uint64_t largest(const BoardConfig& board, const Tables& tables, uint64_t frame) {
  uint64_t cycles = 0;
  for (const ResourceBound& bound : frame_bounds(board, frame_accesses(board, tables), frame))
    cycles = std::max(cycles, bound.cycles);
  return cycles;
}

// small_board(): 6 rows of 16 columns, with 3 slots each. Two of the 18 fetched rows lie outside the image.
// The drain has D - 1 + r columns.
constexpr uint64_t kSlots = uint64_t{16} * 6 * 3;
constexpr uint64_t kReads = uint64_t{16} * (6 * 3 - 2);
constexpr uint64_t kDrain = uint64_t{3} * (3 - 1 + 1);
constexpr uint64_t kWords = 16 * 6 / 4;
constexpr uint64_t kAfter = kDrain + 1 + kPipeline;

class FrameBounds : public ::testing::Test {
 protected:
  std::optional<uint64_t> bound_of(const Tables& tables, const std::string& resource, uint64_t frame = 0) {
    for (const ResourceBound& bound : frame_bounds(board, frame_accesses(board, tables), frame)) {
      if (bound.resource == resource) return bound.cycles;
    }
    return std::nullopt;
  }
  std::optional<uint64_t> bound_of(const std::string& resource, uint64_t frame = 0) {
    return bound_of(identity_tables(board), resource, frame);
  }

  BoardConfig board = small_board();
};

TEST_F(FrameBounds, ListPortsThenBanksThenTheMatcher) {
  std::vector<std::string> names;
  for (const ResourceBound& bound : frame_bounds(board, frame_accesses(board, identity_tables(board)), 1))
    names.push_back(bound.resource);
  EXPECT_EQ(names, (std::vector<std::string>{"port left_lut", "port right_lut", "port left_pixel",
                                             "port right_pixel", "port result", "bank bank1", "bank bank3",
                                             "bank bank5", "bank bank6", "bank bank7", "matcher"}));
}

TEST_F(FrameBounds, GiveAPortOneSlotOrWordACycle) {
  for (const char* port : {"port left_lut", "port right_lut", "port left_pixel", "port right_pixel"})
    EXPECT_EQ(bound_of(port), kSlots + kPipeline) << port;
  EXPECT_EQ(bound_of("port result"), kWords + kPipeline);
}

TEST_F(FrameBounds, AddUpTheAccessesThatShareABank) {
  board.allocation.left_lut = "bank0";
  EXPECT_EQ(bound_of("bank bank0"), 2 * kReads + 2 + kAfter);
  board.allocation.right_lut = "bank0";
  EXPECT_EQ(bound_of("bank bank0"), 3 * kReads + 2 + kAfter);
  board.allocation.disparity = {"bank0"};
  // More writes than what follows the last read: all accesses count.
  EXPECT_EQ(bound_of("bank bank0"), std::max(3 * kReads + 2 + kAfter, 3 * kReads + kWords + kPipeline));
  EXPECT_GT(3 * kReads + kWords + kPipeline, 3 * kReads + 2 + kAfter);
}

// Six rows of 16 words are read. Four of them can be open, so that two are opened between accesses. In 275
// cycles a refresh is due four times; one may fall before or behind all of them.
TEST_F(FrameBounds, CountTheRowsAndTheRefreshesOfSdram) {
  const uint64_t of_ssram = bound_of("bank bank6").value();
  BankConfig& bank = board.banks[6];
  bank.kind = memory::BankKind::kSdram;
  bank.sdram = memory::SdramTiming{2, 16, 4, 5, 1, 64, 3};
  EXPECT_EQ(kReads + 2 * 5 + 3 * 3, 275U);
  EXPECT_EQ(bound_of("bank bank6"), of_ssram + 2 * 5 + 3 * 3);
  bank.sdram->refresh_interval_cycles = std::nullopt;
  EXPECT_EQ(bound_of("bank bank6"), of_ssram + 2 * 5);
  bank.sdram->internal_banks = 8;
  EXPECT_EQ(bound_of("bank bank6"), of_ssram);
}

TEST_F(FrameBounds, CountTheReadsOfLineBuffers) {
  board.matcher.fetch = fpga::Fetch::kLineBuffer;
  const uint64_t after = (3 - 1 + 1) + 1 + kPipeline;
  EXPECT_EQ(bound_of("port left_lut"), uint64_t{16} * 7 + kPipeline);
  EXPECT_EQ(bound_of("bank bank0"), 16 * 6 + 2 + after);
  EXPECT_EQ(bound_of("matcher"), 4 + 16 * 7 + after);
}

TEST_F(FrameBounds, CountTheReadsOfALargeFilter) {
  board.matcher.filter = kernels::log7();  // two strips more, rows 0..5 of -2+3-1 = 0 on
  const uint64_t drain = uint64_t{3} * (3 - 1 + 1 + 3);
  // Strips start at rows 0 .. 7. Inside the image, four have three rows, one has two, one one, two none.
  EXPECT_EQ(bound_of("bank bank0"), 16 * (4 * 3 + 2 + 1) + 2 + drain + 1 + kPipeline);
}

TEST_F(FrameBounds, LeaveOutThePixelsOfEntriesThatAreNotValid) {
  Tables tables = identity_tables(board);
  tables.left->entries[0] = 0;           // row 0 is fetched twice,
  tables.left->entries[16 * 3 + 5] = 0;  // row 3 three times
  EXPECT_EQ(bound_of(tables, "bank bank0"), kReads - 2 - 3 + 2 + kAfter);
  EXPECT_EQ(bound_of(tables, "bank bank6"), kReads + 4 + kAfter);
  EXPECT_EQ(bound_of(tables, "bank bank2"), kReads + 2 + kAfter);
  for (std::uint32_t& entry : tables.left->entries) entry = 0;
  EXPECT_EQ(bound_of(tables, "bank bank0"), std::nullopt);
}

// An identity table has one word for four pixels of a row.
TEST_F(FrameBounds, LeaveOutThePixelsOfWordsThatAreCached) {
  board.fpga.pixel_cache = fpga::PixelCache::kWord;
  Tables tables = identity_tables(board);
  EXPECT_EQ(bound_of(tables, "bank bank0"), kReads / 4 + 2 + kAfter);
  EXPECT_EQ(bound_of(tables, "bank bank6"), kReads + 4 + kAfter);
  tables.left->entries[16 * 3 + 5] = 0;                           // within a word
  tables.left->entries[16 * 3 + 10] = kernels::make_entry(0, 0);  // another word, and back again
  EXPECT_EQ(bound_of(tables, "bank bank0"), kReads / 4 + 2 * 3 + 2 + kAfter);
  board.allocation.left_lut.reset();
  EXPECT_EQ(bound_of("bank bank0"), kReads / 4 + 2 + kAfter);
}

TEST_F(FrameBounds, ReadJointTablesOnce) {
  board.fpga.joint_tables = true;
  board.allocation.right_lut = board.allocation.left_lut;
  EXPECT_EQ(bound_of("bank bank6"), kReads + 4 + kAfter);
  EXPECT_EQ(bound_of("bank bank7"), std::nullopt);
  EXPECT_EQ(bound_of("port right_lut"), std::nullopt);
  EXPECT_EQ(bound_of("matcher"), 4 + kSlots + kAfter);
}

TEST_F(FrameBounds, CountTheRoundsOfAPixelPortWithoutTable) {
  board.allocation.left_lut.reset();
  board.fpga.lane_fifo_slots = 2;
  const uint64_t rounds = (kSlots - 1) / 2;
  EXPECT_EQ(bound_of("port left_pixel"), rounds * 3 + 3 + kAfter);
  EXPECT_EQ(bound_of("port right_pixel"), kSlots + kPipeline);
  EXPECT_EQ(bound_of("port right_lut"), rounds * 5 + 5 + kAfter);
}

TEST_F(FrameBounds, CountThePassesOnEachSlot) {
  board.matcher.units = 1;  // three passes
  const uint64_t after = 3 * kDrain + 1 + kPipeline;
  EXPECT_EQ(bound_of("matcher"), 4 + 3 * kSlots + after);
  EXPECT_EQ(bound_of("bank bank0"), kReads + 2 + 2 + after);
  EXPECT_EQ(bound_of("port left_lut"), kSlots + kPipeline);
  board.fpga.lane_fifo_slots = 2;
  EXPECT_EQ(bound_of("port left_lut"), (kSlots - 1) / 2 * 7 + 7 + after);
}

TEST_F(FrameBounds, AreWhatUncontendedRowsTake) {
  board.fpga.result_fifo_words = 32;
  for (int rows = 1; rows <= 16; ++rows) {
    board.matcher.rows = rows;
    const Tables tables = identity_tables(board);
    EXPECT_EQ(run_core(board, tables, 1).frame_cycles.front(), largest(board, tables, 0)) << rows;
  }
}

using CoreBound = FrameBounds;

TEST_F(CoreBound, RepeatsWithTheLeastCommonMultipleOfTheLists) {
  EXPECT_EQ(allocation_period_frames(board), 2U);
  board.allocation.disparity = {"bank4", "bank5", "bank4"};
  EXPECT_EQ(allocation_period_frames(board), 6U);
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank1"};
  EXPECT_EQ(allocation_period_frames(board), 3U);
}

TEST_F(CoreBound, IsThatOfAWholeTurnOfTheLists) {
  board.allocation.left_lut = "bank1";  // meets the left image in every other frame
  const Tables tables = identity_tables(board);
  const uint64_t first = largest(board, tables, 0);
  const uint64_t second = largest(board, tables, 1);
  EXPECT_EQ(first, 4 + kSlots + kAfter);
  EXPECT_EQ(second, 2 * kReads + 2 + kAfter);
  const Bound bound = core_bound(board, tables);
  EXPECT_DOUBLE_EQ(bound.core, 40e6 * 2 / static_cast<double>(first + second));
  EXPECT_EQ(bound.core_limited_by, "bank bank1");
  const std::vector<ResourceBound> turn = turn_bounds(board, frame_accesses(board, tables));
  ASSERT_EQ(turn.size(), 2U);
  EXPECT_EQ(turn[0].resource, "matcher");
  EXPECT_EQ(turn[0].cycles, first);
  EXPECT_EQ(turn[1].resource, "bank bank1");
  EXPECT_EQ(turn[1].cycles, second);
}

TEST_F(CoreBound, NamesTheLastOfEqualResources) {
  board.allocation.left_lut = "bank0";
  board.allocation.right_lut = "bank2";
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  EXPECT_EQ(bound_of("bank bank0"), bound_of("bank bank2"));
  EXPECT_EQ(core_bound(board, identity_tables(board)).core_limited_by, "bank bank2");
}

TEST_F(FrameBounds, CountTheReadsOrTheWritesOfABankWithSeparatePorts) {
  board.image = {16, 60};  // 240 words of results: more than the cycles after the last read
  board.allocation.disparity = board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  for (BankConfig& bank : board.banks) bank.words = 960;
  const uint64_t reads = uint64_t{16} * (60 * 3 - 2);
  EXPECT_EQ(bound_of("bank bank0"), reads + 240 + kPipeline);
  board.banks[0].kind = memory::BankKind::kQdr;
  EXPECT_EQ(bound_of("bank bank0"), reads + 2 + kAfter);
  board.banks[4].kind = memory::BankKind::kQdr;
  board.allocation.disparity = {"bank4"};
  EXPECT_EQ(bound_of("bank bank4"), 240 + kPipeline);
}

// A changed small board by name, so that each runs in a process of its own.
struct Case {
  const char* name;
  std::function<void(BoardConfig&)> change;
  bool holes = false;  // every third entry of the left table is not valid
};
void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }
std::string name_of(const ::testing::TestParamInfo<Case>& tested) { return tested.param.name; }

void set_kinds(BoardConfig& board, memory::BankKind kind, int turnaround) {
  for (BankConfig& bank : board.banks) bank.kind = kind, bank.turnaround_cycles = turnaround;
}

class BoundedRun : public ::testing::TestWithParam<Case> {
 protected:
  void run(uint64_t frames) {
    GetParam().change(board);
    tables = identity_tables(board);
    for (std::size_t entry = 0; GetParam().holes && entry < tables.left->entries.size(); entry += 3)
      tables.left->entries[entry] = 0;
    statistics = PreloadedRun(board, tables, frames).finish();
    ASSERT_EQ(statistics.frame_cycles.size(), frames);
    EXPECT_EQ(statistics.failed, std::vector<std::string>{});
  }

  BoardConfig board = small_board();
  Tables tables;
  Statistics statistics;
};

constexpr uint64_t kFrames = 4;  // two turns of the lists
constexpr auto kFlowThrough = memory::BankKind::kZbtFlowThrough;

// A run of any board takes at least its bound: this is an identity of its statistics.
class UncontendedBoards : public BoundedRun {};

TEST_P(UncontendedBoards, TakeExactlyTheirBound) {
  run(kFrames);
  for (uint64_t frame = 0; frame < kFrames; ++frame)
    EXPECT_EQ(statistics.frame_cycles[frame], largest(board, tables, frame));
  EXPECT_EQ(statistics.frames_per_second.core, core_bound(board, tables).core);
}

INSTANTIATE_TEST_SUITE_P(
    Bounds, UncontendedBoards,
    ::testing::Values(
        Case{"paper", [](auto&) {}}, Case{"holes", [](auto&) {}, true},
        Case{"line_buffer", [](auto& b) { b.matcher.fetch = fpga::Fetch::kLineBuffer; }},
        Case{"log7", [](auto& b) { b.matcher.filter = kernels::log7(), b.matcher.window = 5; }},
        Case{"large_filter", [](auto& b) { b.matcher.filter = kernels::log7(); }},
        Case{"large_filter_line_buffer",
             [](auto& b) { b.matcher.filter = kernels::log7(), b.matcher.fetch = fpga::Fetch::kLineBuffer; }},
        Case{"flow_through", [](auto& b) { set_kinds(b, kFlowThrough, 0); }},
        Case{"qdr_result_with_image",
             [](auto& b) {
               set_kinds(b, memory::BankKind::kQdr, 0);
               b.allocation.disparity = b.allocation.left_image;
             }},
        Case{"one_slow_bank",
             [](auto& b) {
               set_kinds(b, kFlowThrough, 0);
               b.banks[7].kind = memory::BankKind::kZbtPipelined;
             }},
        Case{"no_tables", [](auto& b) { b.allocation.left_lut.reset(), b.allocation.right_lut.reset(); }},
        Case{"no_left_table", [](auto& b) { b.allocation.left_lut.reset(); }},
        Case{"joint_tables_and_word_cache",
             [](auto& b) {
               b.fpga.joint_tables = true;
               b.fpga.pixel_cache = fpga::PixelCache::kWord;
               b.allocation.right_lut = b.allocation.left_lut;
             },
             true},
        Case{"one_row",
             [](auto& b) {
               b.image = {16, 1};
             }},
        Case{"window_larger_than_image", [](auto& b) { b.matcher.window = 31, b.matcher.disparities = 40; }},
        Case{"passes", [](auto& b) { b.matcher.units = 1; }},
        Case{"passes_line_buffer",
             [](auto& b) { b.matcher.units = 2, b.matcher.fetch = fpga::Fetch::kLineBuffer; }},
        Case{"no_pipeline", [](auto& b) { b.fpga.pipeline_latency_cycles = 0; }},
        Case{"result_delay", [](auto& b) { b.fpga.result_delay_cycles = 20; }},
        Case{"one_place", [](auto& b) { b.fpga.lane_fifo_slots = 1; }},
        Case{"five_places", [](auto& b) { b.fpga.lane_fifo_slots = 5; }}),
    name_of);

class FewPlaces : public BoundedRun {};

TEST_P(FewPlaces, TakeLessThanARoundLongerThanTheirBound) {
  run(1);
  const uint64_t bound = largest(board, tables, 0);
  EXPECT_EQ(core_bound(board, tables).core_limited_by, "port right_lut");
  EXPECT_GE(statistics.frame_cycles[0], bound);
  const int round = board.fpga.lane_fifo_slots * fpga::folds_of(core_config(board));
  EXPECT_LT(statistics.frame_cycles[0], bound + static_cast<uint64_t>(round));
}

INSTANTIATE_TEST_SUITE_P(Bounds, FewPlaces,
                         ::testing::Values(Case{"one_place", [](auto& b) { b.fpga.lane_fifo_slots = 1; }},
                                           Case{"two_places", [](auto& b) { b.fpga.lane_fifo_slots = 2; }},
                                           Case{"four_places", [](auto& b) { b.fpga.lane_fifo_slots = 4; }},
                                           Case{"two_places_two_passes",
                                                [](auto& b) {
                                                  b.fpga.lane_fifo_slots = 2;
                                                  b.matcher.units = 2;
                                                }}),
                         name_of);

// The FPGA is slow, so that a bank or the core limits the rate.
class SteadyBound : public ::testing::Test {
 protected:
  SteadyBound() {
    board.image = {16, 60};
    board.fpga.clock_mhz = 1;
    board.cameras.frame_rate_hz = 1000;
  }
  double bound() const { return steady_bound(board, identity_accesses(board)); }
  uint64_t least(uint64_t frame) const { return least_frame_cycles(board, identity_accesses(board), frame); }

  const uint64_t reads = uint64_t{16} * (60 * 3 - 2);  // of a picture
  const uint64_t words = 16 * 60 / 4;                  // of a picture or a result
  BoardConfig board = small_board();
};

TEST_F(SteadyBound, IsThatOfTheWholeComputer) {
  EXPECT_DOUBLE_EQ(bound(), core_bound(board, identity_tables(board)).core);
  board.cameras.frame_rate_hz = 10;
  EXPECT_EQ(bound(), 10);
}

// What the core reads and writes, results that are read back, and pictures that are captured. With three
// buffers, no picture and no result is known to be moved beside a certain frame.
TEST_F(SteadyBound, CountsTheWordsThatTheHostMovesInABank) {
  board.allocation.left_image = {"bank0", "bank0", "bank0"};
  board.allocation.right_image = {"bank2", "bank2", "bank2"};
  board.allocation.disparity = {"bank0", "bank3", "bank0"};
  const uint64_t turn = 3 * (reads + words) + 2 * 2 * words;
  ASSERT_GT(turn, least(0) + least(1) + least(2));
  EXPECT_DOUBLE_EQ(bound(), 1e6 * 3 / static_cast<double>(turn));
}

// While frame 0 runs, the picture of frame 1 comes into the bank of the left table, and the result of the
// frame before is read from there. What is moved beside frame 1 goes to banks that it does not use.
TEST_F(SteadyBound, CountsWhatTheHostMovesBesideAFrame) {
  board.cameras.frame_rate_hz = 400;
  board.allocation = {{"bank0", "bank1"}, {"bank2", "bank5"}, {"bank3", "bank1"}, "bank1", "bank4"};
  const uint64_t frame_0 = reads + words + words;
  ASSERT_GT(frame_0, least(0));
  const double turn = static_cast<double>(frame_0 + least(1));
  EXPECT_DOUBLE_EQ(bound(), 1e6 * 2 / turn);
  board.capture.destination = CaptureDestination::kHostMemory;
  EXPECT_DOUBLE_EQ(bound(), 1e6 * 2 / turn);
}

TEST_F(SteadyBound, CountsTheReadsOrTheWritesOfABankWithSeparatePorts) {
  const std::vector<BufferBanks> three(3, "bank0");
  board.allocation = {three, three, three, "bank0", "bank0"};
  board.banks[0].words = 8192;
  board.banks[0].kind = memory::BankKind::kQdr;
  // Pictures, tables and the results that are read back; all writes are fewer.
  const uint64_t cycles = 4 * reads + words;
  ASSERT_GT(cycles, least(0));
  EXPECT_DOUBLE_EQ(bound(), 1e6 / static_cast<double>(cycles));
}

// Nothing is captured or read back beside a frame that has the only buffer.
TEST_F(SteadyBound, CountsCapturesAndReadBacksBetweenFramesThatHaveOneBuffer) {
  const double a_word = local_bus_cycles_a_word(board, board.bridge.local_clock_mhz);
  const double read_back = a_word * static_cast<double>(words);
  board.allocation.disparity = {"bank5"};
  const auto frame = static_cast<double>(least(0));
  EXPECT_DOUBLE_EQ(bound(), 1e6 / (frame + read_back));
  board.allocation.disparity = {"bank5", "bank5", "bank5"};
  board.allocation.left_image = {"bank0"};
  board.allocation.right_image = {"bank2"};
  board.cameras.trigger = CameraTrigger::kOnDemand;
  const capture::CameraTiming camera({16, 60, 1000, CameraTrigger::kOnDemand});
  const double capture = static_cast<double>(camera.last_pixel_ps()) / 1e6;
  EXPECT_DOUBLE_EQ(bound(), 1e6 / (frame + capture));
  board.cameras.trigger = CameraTrigger::kFreeRunning;  // 1000 cycles a period
  EXPECT_DOUBLE_EQ(bound(), 1000 / std::ceil((frame + capture) / 1000));
  board.capture.destination = CaptureDestination::kHostMemory;
  EXPECT_DOUBLE_EQ(bound(), 1e6 / (frame + 2 * read_back));
  board.capture.host_frames = 1;
  board.cameras.frame_rate_hz = 250;  // 4000 cycles a period
  EXPECT_DOUBLE_EQ(bound(), 250 / std::ceil((4 * capture + 2 * read_back) / 4000));
}

}  // namespace
}  // namespace stereotlm::platform
