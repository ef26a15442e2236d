#include <gtest/gtest.h>

#include <cstddef>
#include <initializer_list>
#include <vector>

#include "tests/unit/support/worked_board.h"

namespace stereotlm::test {
namespace {

class PlainCoreFullSize : public testing::TestWithParam<WorkedBoard> {};

TEST_P(PlainCoreFullSize, HasTheWorkedCycles) { expect_worked_cycles(GetParam()); }

// Board fpl2003 without filter.
PlainCycleInput fpl2003() {
  PlainCycleInput board;
  board.width = 640;
  board.height = 480;
  board.window = 7;
  board.disparities = 80;
  board.banks.resize(8);
  board.left_image = {0, 1};
  board.right_image = {2, 3};
  board.disparity = {4, 5};
  board.left_lut = 6;
  board.right_lut = 7;
  return board;
}

PlainCycleInput with(PlainCycleInput board, const Change& change) {
  change(board);
  return board;
}

// So many banks from `first` on.
PlainBuffer banks_from(int first, int count) {
  PlainBuffer buffer;
  buffer.banks.clear();
  for (int bank = first; bank < first + count; ++bank) buffer.banks.push_back(bank);
  return buffer;
}

// Pictures and table of each side over n banks of their own, results in one more.
PlainCycleInput striped(int lanes, int n) {
  PlainCycleInput board = fpl2003();
  board.lanes = lanes;
  board.banks.resize(static_cast<std::size_t>(4 * n + 1));
  board.left_image = {banks_from(0, n)};
  board.right_image = {banks_from(n, n)};
  board.left_lut = banks_from(2 * n, n);
  board.right_lut = banks_from(3 * n, n);
  board.disparity = {4 * n};
  return board;
}
PlainCycleInput striped(int lanes) { return striped(lanes, lanes); }

// Joint table over a banks, word cache, all pictures and results over b others.
PlainCycleInput joint(int lanes, int a, int b) {
  PlainCycleInput board = fpl2003();
  board.lanes = lanes;
  board.joint_tables = true;
  board.word_cache = true;
  board.left_lut = board.right_lut = banks_from(0, a);
  for (auto* list : {&board.left_image, &board.right_image, &board.disparity})
    list->assign(list->size(), banks_from(a, b));
  return board;
}

void filter(PlainCycleInput& board) { board.filter_half = kLog7Half; }

Change in_sdram(std::initializer_list<std::size_t> banks, PlainSdram sdram = {}) {
  return [=](PlainCycleInput& board) {
    for (const std::size_t bank : banks) board.banks[bank] = {PlainBankKind::kSdram, 0, sdram};
  };
}
PlainCycleInput all_in_sdram(PlainSdram sdram = {}) {
  return with(fpl2003(), in_sdram({0, 1, 2, 3, 4, 5, 6, 7}, sdram));
}

std::vector<WorkedBoard> full_size_boards() {
  const auto rows4 = [](PlainCycleInput& board) { board.rows = 4; };
  return {
      {"P2", striped(2), {1'229'149}},
      {"P2Log7", with(striped(2), filter), {1'229'161}},
      {"P3", striped(3), {921'867}},
      {"P4", striped(4), {614'585}},
      {"P4Log7", with(striped(4), filter), {614'591}},
      {"P4NoTables", with(striped(4), [](auto& b) { b.left_lut.reset(), b.right_lut.reset(); }), {614'583}},
      {"P4N2", striped(4, 2), {1'224'616}},
      {"P4N3", striped(4, 3), {917'956}},
      {"P7", striped(7), {307'303}},
      {"P7N4", striped(7, 4), {620'355}},
      {"P3N2", striped(3, 2), {1'526'243}},
      {"P4NoStripes", with(fpl2003(), [](auto& b) { b.lanes = 4; }), {2'142'909}},
      {"P2Joint2And1", joint(2, 2, 1), {1'305'319}},
      {"P3Joint3And2", joint(3, 3, 2), {921'879}},
      {"P4Joint4And4", joint(4, 4, 4), {615'561}},
      {"P4Joint4And4Log7", with(joint(4, 4, 4), filter), {614'593}},
      {"Rows4P5", with(striped(5), rows4), {153'788}},
      {"Rows4P5Joint5And2", with(joint(5, 5, 2), rows4), {306'483}},
      {"Rows4P10", with(striped(10), [](auto& b) { b.rows = 4, b.result_fifo_words = 16; }), {76'906}},
      {"Units20P4", with(striped(4), [](auto& b) { b.units = 20; }), {2'458'277}},
      {"SdramLeftPictures", with(fpl2003(), in_sdram({0, 1})), {3'094'517}},
      {"SdramDisparities", with(fpl2003(), in_sdram({4, 5})), {2'150'995}},
      {"SdramLeftTable", with(fpl2003(), in_sdram({6})), {5'840'967}},
      {"SdramAll", all_in_sdram(), {5'840'968}},
      {"SdramAllRefreshOff", all_in_sdram({2, 256, 4, 1, 1, 0}), {5'806'391}},
      {"SdramAllRows1024", all_in_sdram({2, 1024, 4, 1, 1, 625, 3}), {3'094'509}},
      {"SdramAllLineBuffer",
       with(all_in_sdram(), [](auto& b) { b.fetch = PlainFetch::kLineBuffer; }),
       {312'903}},
      {"SdramAllLog7", with(all_in_sdram(), filter), {5'832'159, 5'832'159, 5'832'167}},
      {"SdramStripedP4",
       with(striped(4), [](auto& b) { b.banks.assign(b.banks.size(), PlainBank{PlainBankKind::kSdram}); }),
       {633'974}},
  };
}

INSTANTIATE_TEST_SUITE_P(Section8, PlainCoreFullSize, testing::ValuesIn(full_size_boards()), name_of_case);

}  // namespace
}  // namespace stereotlm::test
