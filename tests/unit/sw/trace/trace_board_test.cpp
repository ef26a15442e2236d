#include "sw/trace/trace_board.h"

#include <gtest/gtest.h>

namespace stereotlm::trace {
namespace {

platform::BoardConfig board_of(int rows, fpga::Fetch fetch) {
  platform::BoardConfig board;
  board.image = {8, 5};
  board.matcher.window = 3;
  board.matcher.disparities = 4;
  board.matcher.rows = rows;
  board.matcher.fetch = fetch;
  board.matcher.filter.reset();
  return board;
}

// Against the cursor of the core, which goes from slot to slot.
TEST(TraceBoard, FindsThePlaceOfEachSlotAndTheSlotsOfEachWord) {
  for (const platform::BoardConfig& config :
       {board_of(1, fpga::Fetch::kColumn), board_of(2, fpga::Fetch::kColumn),
        board_of(1, fpga::Fetch::kLineBuffer)}) {
    const TraceBoard board(config);
    fpga::SlotCursor cursor(board.geometry, 0);
    for (std::uint64_t slot = 0; slot < board.geometry.slots; ++slot, cursor.advance()) {
      ASSERT_EQ(board.place_of_slot(slot).row, cursor.row()) << slot;
      ASSERT_EQ(board.place_of_slot(slot).column, cursor.column()) << slot;
    }
    for (std::uint64_t word = 0; word < board.geometry.result_words; ++word) {
      const SlotPlace result = board.place_of_word(word);
      const auto slots = board.slots_of_word(word);
      ASSERT_TRUE(slots);
      for (int i = 0; i < 4; ++i) {
        const SlotPlace pixel = board.place_of_slot((*slots)[static_cast<std::size_t>(i)]);
        EXPECT_EQ(pixel.row, result.row);
        EXPECT_EQ(pixel.column, result.column + i);
        if (board.geometry.slots_per_column > 1) {
          EXPECT_EQ(pixel.strip, result.strip);
        }
      }
    }
  }
}

TEST(TraceBoard, PutsTheWordsOfAGroupOfColumnsOneBehindTheOther) {
  const TraceBoard board(board_of(2, fpga::Fetch::kColumn));
  const int rows_of_words[] = {0, 1, 0, 1, 2, 3, 2, 3, 4, 4};  // the last strip has one row inside
  const int columns_of_words[] = {0, 0, 4, 4, 0, 0, 4, 4, 0, 4};
  for (std::uint64_t word = 0; word < 10; ++word) {
    EXPECT_EQ(board.place_of_word(word).row, rows_of_words[word]);
    EXPECT_EQ(board.place_of_word(word).column, columns_of_words[word]);
  }
}

TEST(TraceBoard, KnowsNoSlotOfAPixelThatTheFilterTookFromAnEarlierStrip) {
  platform::BoardConfig board;
  board.image = {8, 5};
  board.matcher.window = 3;  // narrower than the filter
  EXPECT_EQ(TraceBoard(board).slots_of_word(0), std::nullopt);
}

}  // namespace
}  // namespace stereotlm::trace
