// The stages from matches to the disparity buffer, each alone.
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "models/fpga/lr_check.h"
#include "models/fpga/result_packer.h"
#include "models/fpga/result_writer.h"
#include "models/memory/ssram_bank.h"
#include "tests/support/expected_report.h"
#include "tests/support/monitoring_binder.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using test::ExpectedReport;

constexpr std::uint8_t kNone = 255;

void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }

// Matches of 8 pixels with D = 3 through the check. `left` and `right` are by pixel; unit A is two columns
// behind.
std::vector<int> check(std::optional<int> tolerance, const std::vector<std::uint8_t>& left,
                       const std::vector<std::uint8_t>& right, LrCheck::Stats* stats = nullptr) {
  CoreConfig config;
  config.width = 8;
  config.height = 1;
  config.window = 3;
  config.disparities = 3;
  config.filter.reset();
  config.lr_tolerance = tolerance;
  LrCheck lr_check("lr_check", config);
  Collected<Disparity> disparities;
  lr_check.disparities_out.bind(disparities);
  elaborate();
  std::vector<int> values;
  for (int frame = 0; frame < 2; ++frame) {
    disparities.beats.clear();
    lr_check.start_frame();
    for (std::size_t column = 0; column < left.size() + 2; ++column) {
      const RightMatch of_right{column < 2 ? kNone : right[column - 2]};
      const LeftMatch of_left{column < left.size() ? left[column] : kNone, column != 6};
      if (column % 2 == 0) lr_check.right_in->push(of_right);
      lr_check.left_in->push(of_left);
      if (column % 2 != 0) lr_check.right_in->push(of_right);
      EXPECT_EQ(disparities.beats.size(), column < 2 ? 0 : column - 1);
    }
    values.clear();
    for (const Disparity& disparity : disparities.beats) values.push_back(disparity.value);
  }
  if (stats != nullptr) *stats = lr_check.stats();
  return values;
}

//                                       pixel 0  1  2  3  4  5     6  7
const std::vector<std::uint8_t> kLeftBased = {0, 1, 2, 1, 2, kNone, 0, 1};
const std::vector<std::uint8_t> kRightBased = {2, 0, 1, kNone, 2, 0, 0, 0};

TEST(LrCheck, KeepsADisparityThatTheRightPixelConfirms) {
  // Left pixel x points to right pixel x - dL: 0->0 (2), 1->0 (2), 2->0 (2), 3->2 (1), 4->2 (1), 7->6 (0).
  EXPECT_EQ(check(0, kLeftBased, kRightBased), (std::vector<int>{255, 255, 2, 1, 255, 255, 255, 255}));
}

TEST(LrCheck, AllowsADifferenceOfItsToleranceAndNoMore) {
  EXPECT_EQ(check(1, kLeftBased, kRightBased), (std::vector<int>{255, 1, 2, 1, 2, 255, 255, 1}));
}

TEST(LrCheck, AllowsEveryDifferenceThatTheToleranceCovers) {
  EXPECT_EQ(check(2, kLeftBased, kRightBased), (std::vector<int>{0, 1, 2, 1, 2, 255, 255, 1}));
}

TEST(LrCheck, DropsADisparityWhoseRightPixelHasNone) {
  std::vector<std::uint8_t> left = kLeftBased;
  left[3] = 0;  // points to right pixel 3
  EXPECT_EQ(check(253, left, kRightBased)[3], 255);
}

TEST(LrCheck, HandsOnLeftBasedDisparitiesWhenItIsOff) {
  LrCheck::Stats stats;
  EXPECT_EQ(check(std::nullopt, kLeftBased, kRightBased, &stats),
            (std::vector<int>{0, 1, 2, 1, 2, 255, 255, 1}));  // pixel 6 has no table entry
  EXPECT_EQ(stats.answered, 12U);
  EXPECT_EQ(stats.invalid, 4U);
}

TEST(LrCheck, WaitsForTheRowsAboveTheFirst) {
  CoreConfig config;
  config.width = 8;
  config.height = 2;
  config.window = 3;
  config.disparities = 4;
  config.filter = kernels::log7();
  LrCheck lr_check("lr_check", config);
  Collected<Disparity> disparities;
  lr_check.disparities_out.bind(disparities);
  elaborate();
  lr_check.start_frame();
  // Two strips of 8 columns (w = 3 - 1), and D - 1 columns; filter and window have waited before.
  for (int column = 0; column < 2 * 8 + 3; ++column) {
    lr_check.left_in->push({});
    lr_check.right_in->push({});
    EXPECT_TRUE(disparities.beats.empty());
  }
  lr_check.left_in->push({});
  lr_check.right_in->push({});
  EXPECT_EQ(disparities.beats.size(), 1U);
}

TEST(ResultPacker, PutsTheLowestColumnIntoTheLowestByte) {
  ResultPacker packer("packer");
  Collected<ResultWord> words;
  packer.words_out.bind(words);
  elaborate();
  packer.start_frame();
  for (const unsigned value : {0x11U, 0x22U, 0x33U})
    packer.disparities_in->push({static_cast<std::uint8_t>(value)});
  EXPECT_TRUE(words.beats.empty());
  packer.disparities_in->push({0x44});
  ASSERT_EQ(words.beats.size(), 1U);
  EXPECT_EQ(words.beats[0].word, 0x4433'2211U);
  EXPECT_EQ(packer.stats().words, 1U);
}

TEST(ResultPacker, BeginsAFrameWithAnEmptyWord) {
  ResultPacker packer("packer");
  Collected<ResultWord> words;
  packer.words_out.bind(words);
  elaborate();
  packer.start_frame();
  packer.disparities_in->push({0x11});
  packer.start_frame();
  for (int pixel = 0; pixel < 4; ++pixel) packer.disparities_in->push({0xFF});
  ASSERT_EQ(words.beats.size(), 1U);
  EXPECT_EQ(words.beats[0].word, 0xFFFF'FFFFU);
}

TEST(ResultWriter, RefusesADepthOutsideItsRange) {
  EXPECT_NO_THROW(ResultWriter("a", 1));
  EXPECT_NO_THROW(ResultWriter("b", 64));
  EXPECT_THROW(ResultWriter("c", 0), std::invalid_argument);
  EXPECT_THROW(ResultWriter("d", 65), std::invalid_argument);
}

class ResultWriterTest : public testing::Test {
 protected:
  ResultWriterTest() {
    binder.bind(writer.port, bank.port, "result_to_bank");
    elaborate();
    writer.start_frame(16);
  }
  test::MonitoringBinder binder;
  memory::SsramBank bank{"bank", {8}};
  ResultWriter writer{"writer", 3};
};

TEST_F(ResultWriterTest, WritesWordAfterWordToTheBuffer) {
  writer.words_in->push({1});
  writer.words_in->push({2});
  EXPECT_EQ(bank.stats().writes, 0U);
  writer.write(sc_core::SC_ZERO_TIME);
  EXPECT_EQ(bank.words()[4], 1U);
  EXPECT_EQ(bank.words()[5], 0U);
  writer.write(sc_core::SC_ZERO_TIME);
  EXPECT_EQ(bank.words()[5], 2U);
  EXPECT_EQ(writer.stats().writes, 2U);
  EXPECT_EQ(writer.stats().most_queued_words, 2U);
  EXPECT_EQ(writer.stats().errors, 0U);
}

TEST_F(ResultWriterTest, TakesAsManyWordsAsItIsDeepAndReportsOneMore) {
  for (std::uint32_t word = 0; word < 3; ++word) writer.words_in->push({word});
  EXPECT_EQ(writer.stats().most_queued_words, 3U);
  ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(writer.words_in->push({3}), sc_core::sc_report);
}

TEST_F(ResultWriterTest, ReportsAWriteFromAnEmptyQueue) {
  ExpectedReport report("/stereotlm/result_writer");
  EXPECT_THROW(writer.write(sc_core::SC_ZERO_TIME), sc_core::sc_report);
}

TEST_F(ResultWriterTest, KeepsTheMostWordsOfAllFrames) {
  for (const std::uint64_t most_queued : {2U, 3U, 1U}) writer.count({10, most_queued, 0});
  EXPECT_EQ(writer.stats().writes, 30U);
  EXPECT_EQ(writer.stats().most_queued_words, 3U);
}

TEST_F(ResultWriterTest, CountsWordsThatMemoryRefuses) {
  for (int word = 0; word < 5; ++word) {
    writer.words_in->push({7});
    writer.write(sc_core::SC_ZERO_TIME);
    EXPECT_EQ(writer.stats().errors, word < 4 ? 0U : 1U);
  }
  EXPECT_EQ(bank.stats().writes, 4U);
}

TEST_F(ResultWriterTest, BeginsAFrameAtItsOwnBuffer) {
  writer.words_in->push({7});
  writer.start_frame(4);
  writer.words_in->push({9});
  writer.write(sc_core::SC_ZERO_TIME);
  EXPECT_EQ(bank.words()[1], 9U);
  EXPECT_EQ(bank.words()[4], 0U);
}

}  // namespace
}  // namespace stereotlm::fpga
