#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/unit/support/worked_board.h"

namespace stereotlm::test {
namespace {

constexpr PlainBank kZbt{};
constexpr PlainBank kQdr{PlainBankKind::kQdr};
constexpr PlainBank kSyncBurst2{PlainBankKind::kSyncBurst, 2};

class PlainCoreWorked : public testing::TestWithParam<WorkedBoard> {};

TEST_P(PlainCoreWorked, HasTheWorkedCycles) { expect_worked_cycles(GetParam()); }

// 8 disparities.
PlainCycleInput small(int width, int height, int window, std::vector<PlainBank> banks, const Change& change) {
  PlainCycleInput board;
  board.width = width;
  board.height = height;
  board.window = window;
  board.disparities = 8;
  board.banks = std::move(banks);
  change(board);
  return board;
}

PlainBank sdram(int row_words, int internal_banks, int activate, int precharge, int interval,
                int refresh = 0) {
  return {PlainBankKind::kSdram, 0, {2, row_words, internal_banks, activate, precharge, interval, refresh}};
}

std::vector<WorkedBoard> small_boards() {
  const PlainBank b2 = sdram(16, 2, 4, 3, 70, 9);
  return {
      {"A",
       small(20, 20, 3, std::vector<PlainBank>(5, sdram(16, 4, 4, 3, 90, 3)),
             [](auto& b) {
               b.result_fifo_words = 3, b.arbitration = PlainArbitration::kRoundRobin;
               b.rows = 2, b.word_cache = true, b.lanes = 2;
               b.left_image = {{4, 0}}, b.right_image = {{0, 1}}, b.disparity = {{4, 0, 1, 2}};
               b.left_lut = {0, 1}, b.right_lut = {4, 0, 1, 2};
             }),
       {4357, 4509, 4401}},
      {"B",
       small(32, 18, 7, {kZbt, sdram(16, 4, 4, 3, 100, 9), b2, b2, kZbt},
             [](auto& b) {
               b.lane_fifo_slots = 6, b.result_fifo_words = 3, b.arbitration = PlainArbitration::kAge;
               b.rows = 2, b.lanes = 5;
               b.left_image = {{4, 0, 1}}, b.right_image = {{0, 1, 2}}, b.disparity = {4};
               b.left_lut = 2, b.right_lut = {3, 4, 0};
             }),
       {24'937, 24'974}},
      {"C",
       small(20, 14, 3, std::vector<PlainBank>(2, sdram(16, 2, 3, 5, 100, 3)),
             [](auto& b) {
               b.filter_half = kLog7Half, b.lane_fifo_slots = 6, b.result_fifo_words = 4;
               b.rows = 3, b.lanes = 3;
               b.left_image = {{0, 1}, {0, 1}}, b.right_image = {{1, 0}, {1, 0}}, b.disparity = {{0, 1}};
               b.left_lut = 1, b.right_lut = 1;
             }),
       {12'098, 11'867}},
      {"D",
       small(20, 15, 3, {kSyncBurst2, kSyncBurst2},
             [](auto& b) {
               b.result_fifo_words = 3, b.units = 4, b.rows = 3, b.word_cache = true, b.lanes = 2;
               b.left_image = {0, 1}, b.right_image = {1, 0}, b.disparity = {{1, 0}};
               b.left_lut = 1, b.right_lut = {0, 1};
             }),
       {1048, 1050}},
      {"E",
       small(20, 18, 5, std::vector<PlainBank>(4, kZbt),
             [](auto& b) {
               b.lane_fifo_slots = 4, b.result_fifo_words = 3, b.rows = 2, b.word_cache = true, b.lanes = 2;
               b.left_image = {{1, 2, 3, 0}}, b.right_image = {{2, 3, 0, 1}}, b.disparity = {{3, 0}};
               b.joint_tables = true, b.left_lut = b.right_lut = {3, 0, 1};
             }),
       {841}},
      {"F",
       small(20, 14, 3, {sdram(16, 2, 1, 1, 70, 9), kSyncBurst2, kQdr, kSyncBurst2, sdram(16, 2, 2, 3, 0)},
             [](auto& b) {
               b.result_fifo_words = 4, b.rows = 3, b.lanes = 5;
               b.left_image = {{3, 4}, {1, 2, 3}}, b.right_image = {{4, 0}, {2, 3, 4}}, b.disparity = {0};
               b.left_lut = {4, 0}, b.right_lut = 0;
             }),
       {2086, 1383}},
      {"G",
       small(20, 12, 3, {sdram(16, 4, 1, 8, 74, 20), kZbt, kZbt},
             [](auto& b) {
               b.lane_fifo_slots = 2, b.result_fifo_words = 2, b.pipeline_latency_cycles = 100;
               b.left_image = {0}, b.right_image = {1}, b.disparity = {0};
               b.left_lut = 2, b.right_lut = 2;
             }),
       {4528, 4662, 4662}},
  };
}

// All buffers in one bank.
PlainCycleInput delayed(const PlainBank& bank, int delay, const Change& change) {
  return small(16, 13, 3, {bank}, [&](auto& b) {
    b.left_image = b.right_image = b.disparity = {0}, b.left_lut = b.right_lut = 0;
    b.lane_fifo_slots = 3, b.arbitration = PlainArbitration::kRoundRobin;
    b.result_delay_cycles = delay;
    change(b);
  });
}

// Contract 7.11.
std::vector<WorkedBoard> delayed_boards() {
  const auto fold = [](auto& b) { b.result_fifo_words = 1, b.units = 3, b.fetch = PlainFetch::kLineBuffer; };
  return {
      {"Folds", delayed(kQdr, 5, fold), {1056, 1056}},
      {"FewerRows",
       delayed(kSyncBurst2, 17, [](auto& b) { b.result_fifo_words = 5, b.rows = 4; }),
       {1541, 1541}},
  };
}

INSTANTIATE_TEST_SUITE_P(ResultDelay, PlainCoreWorked, testing::ValuesIn(delayed_boards()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Section8, PlainCoreWorked, testing::ValuesIn(small_boards()), name_of_case);

}  // namespace
}  // namespace stereotlm::test
