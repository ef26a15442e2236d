// The board without modules and without the kernel. Random computers compare its figures with the plain loop.
#include "platform/fast_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"
#include "models/memory/crossbar_address.h"
#include "platform/core_run.h"
#include "tests/support/noise_pairs.h"
#include "tests/support/scratch_folder.h"
#include "tests/unit/platform/computer_registers.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

namespace core = fpga::registers;
using memory::crossbar_address;
using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kClockPs = 25'000;  // a clock of the core and of the local bus

// The test is the master of the local bus. Frame 0 of the small board has its images in banks 0 and 2, its
// disparities in bank 4 and its tables in banks 6 and 7.
class FastBoardTest : public ::testing::Test, public FastBoard::Doorbell, public LocalBusMasterIf {
 protected:
  static constexpr std::uint32_t kImageWords = 24;
  static constexpr std::uint32_t kSpareWord = 500;           // of any other bank: no frame uses it
  static constexpr std::uint32_t kLeftTableBankWords = 100;  // of them 96 of the table

  explicit FastBoardTest(fpga::Fidelity fidelity = fpga::Fidelity::kFast,
                         std::uint64_t stall_timeout_cycles = 1'000'000)
      : board(config, fidelity, *this, stall_timeout_cycles) {
    board.local_bus().bind(*this);
  }
  void ring(std::uint64_t time_ps) override { rings_ps.push_back(time_ps); }
  void end_burst_at(std::uint64_t end_ps, bool ok) override {
    burst_end_ps = end_ps;
    burst_ok = ok;
  }

  // Steps whatever is due up to `end_ps`.
  void run_to(std::uint64_t end_ps) {
    for (;;) {
      const std::uint64_t time_ps = std::min(board.next_ps(), board.local_bus().next_ps());
      if (time_ps > end_ps) break;
      board.next_ps() == time_ps ? board.step(time_ps) : board.local_bus().step(time_ps);
    }
    now_ps = end_ps;
  }
  // Runs a burst from now to its end.
  bool burst(bool write, std::uint64_t address, Words& words) {
    burst_end_ps = kNever;
    auto* const data = reinterpret_cast<unsigned char*>(words.data());
    if (!board.local_bus().begin_burst(now_ps, {write, address, data, words.size()})) return false;
    while (burst_end_ps == kNever) run_to(now_ps + kClockPs);
    run_to(burst_end_ps);
    return burst_ok;
  }
  bool write(std::uint64_t address, Words words) { return burst(true, address, words); }
  Words read(std::uint64_t address, std::size_t count) {
    Words words(count);
    EXPECT_TRUE(burst(false, address, words));
    return words;
  }
  bool write_register(std::uint64_t address, std::uint32_t value) {
    return write(fpga::kLocalRegisters + address, {value});
  }
  std::uint32_t read_register(std::uint64_t address) { return read(fpga::kLocalRegisters + address, 1)[0]; }

  static Words words_of(const kernels::GrayImage& image) {
    Words words(image.pixels.size() / 4);
    kernels::words_of_pixels(image.pixels.data(), static_cast<int>(words.size()), words.data());
    return words;
  }
  void load(std::uint32_t frame) {
    const host::StereoPair& pair = pairs.pair(frame);
    const std::uint32_t other = frame % 2;
    write(crossbar_address(other, 0), words_of(pair.left));
    write(crossbar_address(2 + other, 0), words_of(pair.right));
    set_bases(frame);
  }
  void set_bases(std::uint32_t frame) {
    const std::uint32_t other = frame % 2;
    const std::array<std::uint32_t, 5> banks = {other, 2 + other, 4 + other, 6, 7};
    for (std::size_t buffer = 0; buffer < banks.size(); ++buffer)
      write_register(testing::kBaseRegisters[buffer], core::base(banks[buffer], 0));
  }
  void load_tables() {
    for (const std::uint64_t bank : {6U, 7U}) write(crossbar_address(bank, 0), tables.left->entries);
  }
  // A burst of one word carries the strobe in the clock that ends 3 clocks after its beginning.
  std::uint64_t start() {
    const std::uint64_t strobe_ps = now_ps + 3 * kClockPs;
    write_register(core::kControl, core::kControlAcknowledge | core::kControlStart);
    return strobe_ps;
  }
  // Runs frame `frame` to its end, and returns its disparities.
  Words run_frame(std::uint32_t frame) {
    load(frame);
    start();
    run_to(now_ps + 10'000 * kClockPs);
    EXPECT_EQ(read_register(core::kStatus), core::kStatusDone);
    return read(crossbar_address(4 + frame % 2, 0), kImageWords);
  }
  Words disparities_of(std::uint32_t frame) {
    return words_of(test::disparity_of(pairs.pair(frame), config));
  }

  static BoardConfig board_config() {
    BoardConfig config = testing::small_board();
    config.banks[0].words = 32'768;
    config.banks[6].words = kLeftTableBankWords;
    return config;
  }

  BoardConfig config = board_config();
  Tables tables = identity_tables(config);
  test::NoisePairs pairs{16, 6, 1};
  FastBoard board;
  std::uint64_t now_ps = 0;
  std::uint64_t burst_end_ps = 0;
  bool burst_ok = false;
  std::vector<std::uint64_t> rings_ps;
};

TEST_F(FastBoardTest, RunsFramesWithTheFiguresOfTheCoreAlone) {
  load_tables();
  for (const std::uint32_t frame : {0U, 1U, 2U}) EXPECT_EQ(run_frame(frame), disparities_of(frame)) << frame;
  const Statistics alone = run_core(config, tables, 3);
  EXPECT_EQ(board.frames().frame_cycles(), alone.frame_cycles);
  const Statistics found = collect_statistics(config, frame_accesses(config, tables), "fast",
                                              board.frames().frame_cycles(), board.counters());
  EXPECT_EQ(found.failed, std::vector<std::string>());
  for (std::size_t bank = 0; bank < found.banks.size(); ++bank) {
    EXPECT_EQ(found.banks[bank].reads, alone.banks[bank].reads);
    EXPECT_EQ(found.banks[bank].writes, alone.banks[bank].writes);
  }
}

TEST_F(FastBoardTest, RingsWhenTheInterruptRises) {
  load_tables();
  load(0);
  const std::uint64_t frame_ps = run_core(config, tables, 1).frame_cycles[0] * kClockPs;
  const std::uint64_t first_ps = start();
  EXPECT_EQ(read_register(core::kStatus), core::kStatusBusy);
  run_to(first_ps + frame_ps - 1);
  EXPECT_TRUE(rings_ps.empty());
  EXPECT_TRUE(board.ends_frame_next());
  EXPECT_EQ(board.next_ps(), first_ps + frame_ps);
  run_to(first_ps + frame_ps);
  EXPECT_EQ(rings_ps, std::vector<std::uint64_t>{first_ps + frame_ps});
  EXPECT_EQ(read_register(core::kFrameCyclesLow), frame_ps / kClockPs);
  // It is still high when the next frame ends.
  const std::uint64_t second_ps = now_ps + 3 * kClockPs;
  write_register(core::kControl, core::kControlStart);
  run_to(second_ps + 2 * frame_ps);
  EXPECT_EQ(board.frames().frame_cycles().size(), 2U);
  EXPECT_EQ(rings_ps.size(), 1U);
  start();
  run_to(now_ps + 2 * frame_ps);
  EXPECT_EQ(rings_ps.size(), 2U);
}

// A pixel whose entry is not valid is not read.
TEST_F(FastBoardTest, ReadsATableAgainThatHasChanged) {
  const auto pixels_read = [this] {
    const fpga::PortCycles& port = board.frames().control().port_cycles(fpga::pixel_port(fpga::Side::kLeft));
    const std::uint64_t before = port.granted();
    run_frame(0);
    return port.granted() - before;
  };
  load_tables();
  const std::uint64_t all = pixels_read();
  EXPECT_EQ(pixels_read(), all);
  write(crossbar_address(6, 10), Words(20));
  const std::uint64_t some = pixels_read();
  EXPECT_LT(some, all);
  // A burst beyond the end of the bank is transferred word by word.
  EXPECT_FALSE(write(crossbar_address(6, 40), Words(kLeftTableBankWords - 40 + 1)));
  EXPECT_LT(pixels_read(), some);
}

TEST_F(FastBoardTest, RefusesWordsAndRegistersThatAreNotThere) {
  const std::uint64_t last = crossbar_address(5, config.banks[5].words - 1);
  EXPECT_TRUE(write(last, {7}));
  EXPECT_FALSE(write(last, {8, 9}));  // the second word is beyond the bank
  EXPECT_EQ(read(last, 1), Words{8});
  Words words(2);
  EXPECT_FALSE(burst(false, last, words));
  EXPECT_EQ(words, (Words{8, 0}));
  EXPECT_EQ(board.counters().banks[5].accesses, 6U);
  EXPECT_EQ(board.counters().banks[5].uncounted_grants, 6U);
  const std::uint64_t errors = board.local_bus().stats(now_ps).errors;
  EXPECT_EQ(errors, 2U);
  EXPECT_FALSE(write_register(core::kStatus, 1));
  EXPECT_FALSE(write_register(core::kEnd, 1));
  EXPECT_FALSE(burst(false, fpga::kLocalRegisters + core::kControl, words));
  EXPECT_FALSE(write(crossbar_address(8, 0), {1}));  // no such bank
  EXPECT_EQ(board.local_bus().stats(now_ps).errors, errors + 4);
}

TEST_F(FastBoardTest, RefusesAStrobeWithABaseInABankThatItDoesNotHave) {
  set_bases(0);
  write_register(core::kRightImageBase, core::base(8, 0));
  start();
  run_to(now_ps + 10'000 * kClockPs);
  EXPECT_EQ(read_register(core::kStatus), core::kStatusError);
  EXPECT_TRUE(board.frames().frame_cycles().empty());
  write_register(core::kRightImageBase, core::base(7, 0));
  start();
  EXPECT_EQ(read_register(core::kStatus), core::kStatusBusy);
}

TEST_F(FastBoardTest, NeedsFidelityCycleForAFrameThatCannotWorkDirectlyOnMemory) {
  set_bases(0);
  write_register(core::kDisparityBase, core::base(0, kImageWords - 1));  // over the left image
  EXPECT_EQ(test::message_of([this] { start(); }),
            "core: a frame that does not work directly on memory needs fidelity cycle");
}

TEST_F(FastBoardTest, NeedsFidelityCycleForABurstThatWouldObserveAFrame) {
  set_bases(0);
  start();
  EXPECT_EQ(test::message_of([this] { read(crossbar_address(4, 3), 2); }),
            "core: a burst of the local bus reads words 3..4 of bank number 4, where the running frame has "
            "its disparity: needs fidelity cycle");
}

TEST_F(FastBoardTest, ShowsARunningFrameToObservers) {
  EXPECT_EQ(board.frames().waits(), "the core runs no frame");
  board.catch_up(now_ps);
  set_bases(0);
  board.frames().record_rows();
  const std::uint64_t first_ps = start();
  board.catch_up(first_ps + 30 * kClockPs);
  EXPECT_EQ(board.frames().waits().substr(0, 33), "frame 0 of the core, cycle 30; le");
  run_to(now_ps + 10'000 * kClockPs);
  EXPECT_EQ(board.frames().frame_cycles(), run_core(config, tables, 1).frame_cycles);
  EXPECT_EQ(board.frames().take_rows().size(), 1U);
  EXPECT_TRUE(board.frames().take_rows().empty());
}

// A burst to a bank of the frame takes cycles from it. The host comes first.
TEST_F(FastBoardTest, ArbitratesABurstInABankOfTheRunningFrame) {
  set_bases(0);
  load_tables();
  start();
  const std::uint64_t begin_ps = now_ps;
  write(crossbar_address(0, kSpareWord), Words(20, 5));
  EXPECT_EQ(now_ps, begin_ps + (3 + 20) * kClockPs);
  run_to(now_ps + 10'000 * kClockPs);
  EXPECT_EQ(board.frames().frame_cycles()[0], run_core(config, tables, 1).frame_cycles[0] + 20);
  EXPECT_EQ(read(crossbar_address(0, kSpareWord), 20), Words(20, 5));
  const Statistics found = collect_statistics(config, frame_accesses(config, tables), "fast",
                                              board.frames().frame_cycles(), board.counters());
  EXPECT_EQ(found.failed, std::vector<std::string>());
}

TEST_F(FastBoardTest, ServesOneWordPerCycleInItsBanksThatTheFrameDoesNotUse) {
  const auto serves = [this](std::uint64_t bank, std::uint64_t word, std::uint64_t words) {
    return board.serves_one_word_per_cycle(crossbar_address(bank, word), 4 * words);
  };
  EXPECT_TRUE(serves(6, 0, kLeftTableBankWords));
  EXPECT_FALSE(serves(6, 1, kLeftTableBankWords));
  EXPECT_TRUE(serves(7, 0, 1));
  EXPECT_FALSE(serves(8, 0, 1));
  set_bases(0);
  start();
  EXPECT_FALSE(serves(0, kSpareWord, 1));
  EXPECT_TRUE(serves(1, kSpareWord, 1));
}

class OtherFastBoard : public FastBoardTest {
 public:
  using FastBoardTest::board;
  using FastBoardTest::now_ps;
  using FastBoardTest::run_to;
  using FastBoardTest::set_bases;
  using FastBoardTest::start;

 private:
  void TestBody() override {}
};

// Two bursts of 8 words, stepped or skipped, beside a frame and without one.
TEST_F(FastBoardTest, CountsWordsThatAreSkippedAsThoseOfSteppedBursts) {
  OtherFastBoard other;
  const std::uint64_t address = crossbar_address(1, kSpareWord);
  for (const bool beside_frame : {false, true}) {
    set_bases(0);
    other.set_bases(0);
    if (beside_frame) {
      start();
      other.start();
    }
    const std::uint64_t clock = now_ps / kClockPs;
    const std::uint64_t busy = board.local_bus().busy_clocks();
    write(address, Words(8, 5));
    write(address + 32, Words(8, 6));
    EXPECT_EQ(now_ps, (clock + 2 * 11) * kClockPs);  // address, decode, 8 words, idle
    const std::uint64_t new_busy = board.local_bus().busy_clocks() - busy;
    EXPECT_EQ(new_busy, 2 * 10U);
    std::uint32_t* const words = other.board.skip_words(true, address, 16, clock + 3, clock + 2 * 11);
    other.board.local_bus().skip_bursts(2, new_busy, clock + 2 * 11 - 1);
    EXPECT_EQ(words[0], beside_frame ? 5U : 0U);
    std::fill_n(words, 8, 5U);
    run_to(now_ps + 10'000 * kClockPs);
    other.run_to(now_ps);
    const BoardCounters stepped = board.counters();
    const BoardCounters skipped = other.board.counters();
    EXPECT_EQ(skipped.frames, beside_frame ? 1U : 0U);
    EXPECT_EQ(skipped.banks[1].accesses, stepped.banks[1].accesses);
    EXPECT_EQ(skipped.banks[1].uncounted_grants, stepped.banks[1].uncounted_grants);
    EXPECT_EQ(skipped.banks[1].uncounted_grants, 16U);  // those of the first time
    EXPECT_EQ(skipped.banks[1].arbiter.writes, stepped.banks[1].arbiter.writes);
    EXPECT_EQ(skipped.banks[1].arbiter.busy_cycles, stepped.banks[1].arbiter.busy_cycles);
    EXPECT_EQ(skipped.banks[1].arbiter.idle_cycles, stepped.banks[1].arbiter.idle_cycles);
    EXPECT_EQ(skipped.ports[fpga::kHostPort].granted(), beside_frame ? 16U : 0U);
    EXPECT_EQ(skipped.ports[fpga::kHostPort].granted(), stepped.ports[fpga::kHostPort].granted());
    EXPECT_EQ(other.board.local_bus().stats(now_ps).words_written,
              board.local_bus().stats(now_ps).words_written);
  }
}

class FastBoardTiming : public FastBoardTest {
 protected:
  FastBoardTiming() : FastBoardTest(fpga::Fidelity::kTiming) {}
};

TEST_F(FastBoardTiming, ComputesNoDisparitiesAndTakesAsLong) {
  load_tables();
  write(crossbar_address(4, 0), Words(kImageWords, 77));
  EXPECT_EQ(run_frame(0), Words(kImageWords, 77));
  EXPECT_EQ(board.frames().frame_cycles(), run_core(config, tables, 1).frame_cycles);
}

class FastBoardStall : public FastBoardTest {
 protected:
  FastBoardStall() : FastBoardTest(fpga::Fidelity::kTiming, 8'000) {}
};

// A burst keeps the left picture's bank from the frame, because the host comes first. The frame is checked every
// 8192 cycles.
TEST_F(FastBoardStall, IsReportedWithItsWaits) {
  load_tables();
  set_bases(0);
  start();
  const std::string text =
      test::message_of([this] { write(crossbar_address(0, kImageWords), Words(20'000)); });
  EXPECT_EQ(text.substr(0, text.find(';')), "core: no slot consumed and no result written for 8192 cycles");
  EXPECT_NE(text.find("; frame 0 of the core, cycle "), std::string::npos);
  EXPECT_NE(text.find("left_pixel asks for bank number 0"), std::string::npos);
}

TEST(FastBoardConfig, MustHaveNoProblems) {
  struct NoDoorbell : FastBoard::Doorbell {
    void ring(std::uint64_t) override {}
  } doorbell;
  BoardConfig wrong = testing::small_board();
  wrong.matcher.window = 4;
  EXPECT_THROW(FastBoard(wrong, fpga::Fidelity::kFast, doorbell), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::platform
