// Stages alone: refused accesses, full and empty queues. The core tests what the stages compute and count
// (stereo_core_random_test.cpp, and the random boards of tests/integration/core).
#include <gtest/gtest.h>

#include <stdexcept>

#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/result_writer.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
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

class LutReaderTest : public StageTest<LutReader> {
 protected:
  LutReaderTest() : StageTest(false) {
    stage.entries_out.bind(entries);
    elaborate();
  }
  Collected<TableEntry> entries;
};

TEST_F(LutReaderTest, TakesARefusedAccessForAnEntryThatIsNotValid) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  preload(9, kernels::make_entry(5, 1));
  stage.start_frame(Placement({}, 0, 8), {});
  stage.slots_in->push({1, 1, false, kAt});  // the last word of the bank
  EXPECT_EQ(entries.beats.back().entry, kernels::make_entry(5, 1));
  EXPECT_EQ(stage.errors(), 0U);
  stage.slots_in->push({2, 1, false, kAt});
  EXPECT_EQ(entries.beats.back().entry, 0U);
  EXPECT_EQ(stage.errors(), 1U);
}

CoreConfig core_of_image(int width, int height) {
  CoreConfig core;
  core.width = width;
  core.height = height;
  return core;
}

class PixelReaderTest : public StageTest<PixelReader> {
 protected:
  PixelReaderTest() : StageTest(core_of_image(8, 4), 0) {
    stage.pixels_out.bind(pixels);
    elaborate();
    stage.start_frame(Placement({}, 2, 2));
  }
  void expect_pixel(std::uint8_t value) {
    stage.release();
    EXPECT_EQ(pixels.beats.back().value, value);
    EXPECT_TRUE(pixels.beats.back().valid);
  }
  Collected<MaskedPixel> pixels;
};

TEST_F(PixelReaderTest, ReadsZeroWhereAnAccessIsRefused) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  stage.start_frame(Placement({}, 9, 2));  // one word before the end of the bank
  stage.slots_in->push({3, 0, false, kAt});
  EXPECT_EQ(stage.errors(), 0U);
  stage.slots_in->push({4, 0, false, kAt});
  EXPECT_EQ(stage.errors(), 1U);
  expect_pixel(37);
  expect_pixel(0);
}

TEST_F(PixelReaderTest, ReportsASlotThatItDoesNotHave) {
  stage.entries_in->push({kernels::make_entry(0, 0)});
  stage.start_frame(Placement({}, 2, 2));  // without the slots of the last frame
  const ExpectedReport report("/stereotlm/pixel_reader", 2);
  EXPECT_THROW(stage.handle(kAt), sc_core::sc_report);
  EXPECT_THROW(stage.release(), sc_core::sc_report);
}

class ResultWriterTest : public StageTest<ResultWriter> {
 protected:
  ResultWriterTest() : StageTest(3) {
    elaborate();
    stage.start_frame(Placement({}, 4, 2));
  }
  void write(std::uint32_t word) {
    stage.words_in->push({word, word - 4});
    stage.write(kAt);
  }
};

TEST_F(ResultWriterTest, TakesAsManyWordsAsItIsDeepAndReportsOneMore) {
  for (std::uint32_t word = 0; word < 3; ++word) stage.words_in->push({word, word});
  const ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(stage.words_in->push({3, 3}), sc_core::sc_report);
}

TEST_F(ResultWriterTest, ReportsAWriteFromAnEmptyQueue) {
  stage.words_in->push({7, 0});
  stage.start_frame(Placement({}, 1, 2));  // without the word of the last frame
  const ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(stage.write(kAt), sc_core::sc_report);
}

TEST_F(ResultWriterTest, CountsWordsThatMemoryRefuses) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  for (std::uint32_t word = 4; word <= 10; ++word) {
    write(word);
    EXPECT_EQ(stage.errors(), word < 10 ? 0U : 1U);
  }
  EXPECT_EQ(bank.words()[4], 4U);
  EXPECT_EQ(bank.words()[9], 9U);
  EXPECT_EQ(bank.stats().writes, 6U);
}

TEST(ResultWriter, RefusesADepthOutsideItsRange) {
  EXPECT_NO_THROW(ResultWriter("a", 1));
  EXPECT_NO_THROW(ResultWriter("b", 64));
  EXPECT_THROW(ResultWriter("c", 0), std::invalid_argument);
  EXPECT_THROW(ResultWriter("d", 65), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::fpga
