// Stages alone: slots, refused accesses, full and empty queues. What the stages compute and count is tested
// through the core (stereo_core_test.cpp, stereo_core_random_test.cpp, and the random boards of
// tests/integration/core).
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/result_packer.h"
#include "models/fpga/result_writer.h"
#include "models/fpga/row_buffer.h"
#include "models/fpga/sequencer.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/ssram_bank.h"
#include "tests/support/expected_report.h"
#include "tests/support/monitoring_binder.h"
#include "tests/unit/fpga/random_core.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using test::ExpectedReport;

const sc_core::sc_time kAt(75, sc_core::SC_NS);

// A stage of an image of 8 columns, and a bank of 10 words behind it. From word 2 on the bank holds 8 x 4
// pixels of value 10 * row + column.
template <class Stage>
class StageTest : public testing::Test {
 protected:
  template <typename... Arguments>
  explicit StageTest(const Arguments&... arguments) : stage("stage", arguments...) {
    binder.bind(stage.port, bank.port, "stage_to_bank");
  }
  void elaborate() {
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    for (std::uint32_t word = 0; word < 8; ++word)
      preload(2 + word, 0x0302'0100U + 0x0101'0101U * (10 * (word / 2) + 4 * (word % 2)));
  }
  void preload(std::uint32_t word, std::uint32_t value) {
    tlm::tlm_generic_payload payload;
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    payload.set_address(word * 4);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(&value));
    payload.set_data_length(4);
    ASSERT_EQ(stage.port->transport_dbg(payload), 4U);
  }

  test::MonitoringBinder binder;
  memory::SsramBank bank{"bank", {10}};
  Stage stage;
};

TEST(Sequencer, SendsTheSlotsOfItsSideWithTheTimesOfTheirCycles) {
  Sequencer sequencer("sequencer");
  Collected<Slot> left;
  Collected<Slot> right;
  sequencer.left_out.bind(left);
  sequencer.right_out.bind(right);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  sequencer.issue(Side::kRight, SlotCursor{FrameGeometry(small_core(8, 6))}, kAt);
  EXPECT_TRUE(left.beats.empty());
  ASSERT_EQ(right.beats.size(), 1U);
  EXPECT_EQ(right.beats[0].row, -1);
  EXPECT_TRUE(right.beats[0].empty);
  EXPECT_EQ(right.beats[0].at, kAt);
}

class LutReaderTest : public StageTest<LutReader> {
 protected:
  explicit LutReaderTest(bool has_joint_tables = false) : StageTest(8, has_joint_tables) {
    stage.entries_out.bind(entries);
    if (has_joint_tables) stage.right_entries_out.bind(right_entries);
    elaborate();
  }
  Collected<TableEntry> entries;
  Collected<TableEntry> right_entries;
};

TEST_F(LutReaderTest, TakesARefusedAccessForAnEntryThatIsNotValid) {
  preload(9, kernels::make_entry(5, 1));
  stage.start_frame(0, {});
  stage.slots_in->push({1, 1, false, kAt});  // the last word of the bank
  EXPECT_EQ(entries.beats.back().entry, kernels::make_entry(5, 1));
  EXPECT_EQ(stage.stats().errors, 0U);
  stage.slots_in->push({2, 1, false, kAt});
  EXPECT_EQ(entries.beats.back().entry, 0U);
  EXPECT_EQ(stage.stats().errors, 1U);
}

class JointLutReaderTest : public LutReaderTest {
 protected:
  JointLutReaderTest() : LutReaderTest(true) {}
};

TEST_F(JointLutReaderTest, GivesBothSidesTheirEntriesOfAWord) {
  preload(9, 0x8000'0000U | 70U << 24U | 130U << 16U);  // left: 6 rows and 2 columns; right: not valid
  preload(8, 0x8000U | 60U << 8U | 120U);               // right: -4 rows and -8 columns; left: not valid
  stage.start_frame(0, {{{-1, 20}, {10, 5}}});
  stage.slots_in->push({1, 1, false, kAt});
  EXPECT_EQ(entries.beats.back().entry, kernels::make_entry(1 + 2 - 1, 1 + 6 + 20));
  EXPECT_EQ(right_entries.beats.back().entry, 0U);
  stage.slots_in->push({0, 1, false, kAt});
  EXPECT_EQ(entries.beats.back().entry, 0U);
  EXPECT_EQ(right_entries.beats.back().entry, kernels::make_entry(0 - 8 + 10, 1 - 4 + 5));
  EXPECT_EQ(stage.stats().reads, 2U);
  EXPECT_EQ(stage.stats().invalid_entries, 2U);
  stage.slots_in->push({2, -1, true, kAt});
  stage.slots_in->push({2, 1, false, kAt});  // refused
  for (const auto* side : {&entries, &right_entries}) {
    EXPECT_EQ(side->beats.size(), 4U);
    EXPECT_EQ(side->beats.back().entry, 0U);
  }
  EXPECT_EQ(stage.stats().empty_slots, 1U);
  EXPECT_EQ(stage.stats().errors, 1U);
}

class PixelReaderTest : public StageTest<PixelReader> {
 protected:
  explicit PixelReaderTest(PixelCache cache = PixelCache::kNone) : StageTest(core_of(cache)) {
    stage.pixels_out.bind(pixels);
    elaborate();
    stage.start_frame(8);
  }
  // Three slots per column.
  static CoreConfig core_of(PixelCache cache) {
    CoreConfig config = small_core(8, 4);
    config.pixel_cache = cache;
    return config;
  }
  void expect_pixel(std::uint8_t value) {
    stage.release();
    EXPECT_EQ(pixels.beats.back().value, value);
    EXPECT_TRUE(pixels.beats.back().valid);
  }
  Collected<MaskedPixel> pixels;
};

TEST_F(PixelReaderTest, KeepsAFullLaneInOrder) {
  for (int slot = 0; slot < 64; ++slot) stage.entries_in->push({kernels::make_entry(slot % 8, slot / 8 % 4)});
  for (int slot = 0; slot < 64; ++slot) stage.handle(kAt);
  for (int slot = 0; slot < 64; ++slot) expect_pixel(static_cast<std::uint8_t>(slot / 8 % 4 * 10 + slot % 8));
}

class CachedPixelReaderTest : public PixelReaderTest {
 protected:
  CachedPixelReaderTest() : PixelReaderTest(PixelCache::kWord) {}
  // The entry of the next slot; 0: not valid.
  bool reads(std::uint32_t entry) {
    const std::uint64_t reads = stage.stats().reads;
    stage.entries_in->push({entry});
    const bool needs_access = stage.needs_access();
    stage.handle(kAt);
    EXPECT_EQ(stage.stats().reads - reads, needs_access ? 1U : 0U);
    return needs_access;
  }
};

TEST_F(CachedPixelReaderTest, ReadsAWordOfASlotOfTheColumnOnlyOnce) {
  EXPECT_TRUE(reads(kernels::make_entry(0, 0)));
  EXPECT_TRUE(reads(kernels::make_entry(1, 0)));  // another slot of the column
  EXPECT_TRUE(reads(kernels::make_entry(5, 3)));
  EXPECT_FALSE(reads(kernels::make_entry(3, 0)));  // the next column
  EXPECT_FALSE(reads(0));
  EXPECT_TRUE(reads(kernels::make_entry(3, 3)));
  EXPECT_TRUE(reads(kernels::make_entry(4, 0)));
  EXPECT_FALSE(reads(kernels::make_entry(2, 0)));  // kept over a slot without valid entry
  EXPECT_TRUE(reads(kernels::make_entry(5, 3)));   // no longer kept
  for (const int value : {0, 1, 35, 3}) expect_pixel(static_cast<std::uint8_t>(value));
  stage.release();
  for (const int value : {33, 4, 2, 35}) expect_pixel(static_cast<std::uint8_t>(value));
  EXPECT_EQ(stage.stats().passed_slots, 3U);
}

TEST_F(CachedPixelReaderTest, ForgetsItsWordsWhereAStripBegins) {
  for (int slot = 0; slot < 3 * 8; ++slot) {
    EXPECT_EQ(reads(kernels::make_entry(0, 0)), slot < 3) << slot;
    expect_pixel(0);
  }
  for (int slot = 0; slot < 6; ++slot) EXPECT_EQ(reads(kernels::make_entry(1, 0)), slot < 3) << slot;
  stage.start_frame(8);
  EXPECT_TRUE(reads(kernels::make_entry(1, 0)));
}

TEST_F(CachedPixelReaderTest, HandlesAWordThatItHasNotReadYet) {
  for (int slot = 0; slot < 6; ++slot) {
    stage.entries_in->push({kernels::make_entry(slot, slot % 3)});
    EXPECT_EQ(stage.needs_access(), slot < 3 || slot > 3) << slot;
  }
  for (int slot = 0; slot < 6; ++slot) {
    stage.handle(kAt);
    expect_pixel(static_cast<std::uint8_t>(slot % 3 * 10 + slot));
  }
}

TEST_F(PixelReaderTest, ReadsZeroWhereAnAccessIsRefused) {
  stage.start_frame(36);  // one word before the end of the bank
  stage.slots_in->push({3, 0, false, kAt});
  EXPECT_EQ(stage.stats().errors, 0U);
  stage.slots_in->push({4, 0, false, kAt});
  EXPECT_EQ(stage.stats().errors, 1U);
  expect_pixel(37);
  expect_pixel(0);
}

TEST_F(PixelReaderTest, ReportsASlotThatItDoesNotHave) {
  stage.entries_in->push({kernels::make_entry(0, 0)});
  stage.start_frame(8);  // without the slots of the last frame
  const ExpectedReport report("/stereotlm/pixel_reader", 2);
  EXPECT_THROW(stage.handle(kAt), sc_core::sc_report);
  EXPECT_THROW(stage.release(), sc_core::sc_report);
}

TEST(RowBuffer, RefusesASizeOutsideItsRange) {
  EXPECT_THROW(RowBuffer("narrow", 3, 3, 1), std::invalid_argument);
  EXPECT_THROW(RowBuffer("even", 4, 2, 1), std::invalid_argument);
  EXPECT_THROW(RowBuffer("empty", 4, 3, 0), std::invalid_argument);
}

TEST(RowBuffer, BeginsAFrameAtTheFirstColumn) {
  RowBuffer rows("rows", 4, 3, 1);
  Collected<PixelColumn> columns;
  rows.columns_out.bind(columns);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  PixelColumn pixel;
  const std::vector<std::uint8_t> values = {99, 1};
  for (const std::uint8_t& value : values) {
    rows.start_frame();
    pixel.values = &value;
    rows.columns_in->push(pixel);
  }
  EXPECT_EQ(columns.beats.back().values[1], 99);
  EXPECT_EQ(columns.beats.back().values[2], 1);
}

TEST(ResultPacker, BeginsAFrameWithAnEmptyWord) {
  ResultPacker packer("packer", small_core(8, 6));
  Collected<ResultWord> words;
  packer.words_out.bind(words);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  packer.start_frame();
  packer.disparities_in->push({0, 0x11});
  packer.start_frame();
  for (const std::uint8_t disparity : std::vector<std::uint8_t>{0x22, 0x33, 0x44, 0x55})
    packer.disparities_in->push({0, disparity});
  ASSERT_EQ(words.beats.size(), 1U);
  EXPECT_EQ(words.beats[0].word, 0x5544'3322U);
}

// Two words per row, three rows per strip.
TEST(ResultPacker, GivesEachWordItsPlaceInTheImage) {
  CoreConfig config = small_core(8, 6);
  config.rows = 3;
  ResultPacker packer("packer", config);
  Collected<ResultWord> words;
  packer.words_out.bind(words);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  for (int frame = 0; frame < 2; ++frame) {
    words.beats.clear();
    packer.start_frame();
    for (int column = 0; column < 2 * 8; ++column) {
      for (int row = 0; row < 3; ++row)
        packer.disparities_in->push({row, static_cast<std::uint8_t>(16 * row + column)});
    }
    std::vector<std::uint64_t> places;
    for (const ResultWord& word : words.beats) places.push_back(word.place);
    EXPECT_EQ(places, (std::vector<std::uint64_t>{0, 2, 4, 1, 3, 5, 6, 8, 10, 7, 9, 11}));
    EXPECT_EQ(words.beats[1].word, 0x1312'1110U);
    EXPECT_EQ(words.beats[11].word, 0x2F2E'2D2CU);
  }
}

class ResultWriterTest : public StageTest<ResultWriter> {
 protected:
  ResultWriterTest() : StageTest(3) {
    elaborate();
    stage.start_frame(16);
  }
  void write(std::uint32_t word) {
    stage.words_in->push({word, word - 4});
    stage.write(kAt);
  }
};

TEST_F(ResultWriterTest, TakesAsManyWordsAsItIsDeepAndReportsOneMore) {
  for (std::uint32_t word = 0; word < 3; ++word) stage.words_in->push({word, word});
  EXPECT_EQ(stage.stats().most_queued_words, 3U);
  const ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(stage.words_in->push({3, 3}), sc_core::sc_report);
}

TEST_F(ResultWriterTest, ReportsAWriteFromAnEmptyQueue) {
  stage.words_in->push({7, 0});
  stage.start_frame(4);  // without the word of the last frame
  const ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(stage.write(kAt), sc_core::sc_report);
}

TEST_F(ResultWriterTest, CountsWordsThatMemoryRefuses) {
  for (std::uint32_t word = 4; word <= 10; ++word) {
    write(word);
    EXPECT_EQ(stage.stats().errors, word < 10 ? 0U : 1U);
  }
  EXPECT_EQ(bank.words()[4], 4U);
  EXPECT_EQ(bank.words()[9], 9U);
  EXPECT_EQ(bank.stats().writes, 6U);
}

TEST_F(ResultWriterTest, KeepsTheMostWordsOfAllFrames) {
  for (const std::uint64_t most_queued : {2U, 3U, 1U}) stage.count({10, most_queued, 0});
  EXPECT_EQ(stage.stats().writes, 30U);
  EXPECT_EQ(stage.stats().most_queued_words, 3U);
}

TEST(ResultWriter, RefusesADepthOutsideItsRange) {
  EXPECT_NO_THROW(ResultWriter("a", 1));
  EXPECT_NO_THROW(ResultWriter("b", 64));
  EXPECT_THROW(ResultWriter("c", 0), std::invalid_argument);
  EXPECT_THROW(ResultWriter("d", 65), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::fpga
