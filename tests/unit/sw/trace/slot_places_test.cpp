#include "sw/trace/slot_places.h"

#include <gtest/gtest.h>

#include "platform/config/board_config.h"

namespace stereotlm::trace {
namespace {

fpga::FrameGeometry geometry_of(int rows, fpga::Fetch fetch, int window = 3) {
  platform::BoardConfig board;
  board.image = {8, 5};
  board.matcher.window = window;
  board.matcher.disparities = 4;
  board.matcher.rows = rows;
  board.matcher.fetch = fetch;
  board.matcher.filter.reset();
  return fpga::FrameGeometry(platform::core_config(board));
}

TEST(SlotPlaces, AgreeWithTheCursorOfTheCore) {
  for (const fpga::FrameGeometry& geometry :
       {geometry_of(1, fpga::Fetch::kColumn), geometry_of(2, fpga::Fetch::kColumn),
        geometry_of(1, fpga::Fetch::kLineBuffer)}) {
    const SlotPlaces places(geometry);
    fpga::SlotCursor cursor(geometry);
    for (std::uint64_t slot = 0; slot < geometry.slots; ++slot, cursor.advance()) {
      ASSERT_EQ(places.place(slot).row, cursor.row()) << slot;
      ASSERT_EQ(places.place(slot).column, cursor.column()) << slot;
    }
  }
}

TEST(SlotPlaces, FindTheSlotsOfTheFourPixelsOfEachWord) {
  for (const fpga::FrameGeometry& geometry :
       {geometry_of(1, fpga::Fetch::kColumn), geometry_of(2, fpga::Fetch::kColumn),
        geometry_of(1, fpga::Fetch::kLineBuffer)}) {
    const SlotPlaces places(geometry);
    for (std::uint64_t word = 0; word < geometry.result_words; ++word) {
      const SlotPlace result = places.place_of_word(word);
      const auto slots = places.slots_of_word(word);
      ASSERT_TRUE(slots);
      for (int i = 0; i < 4; ++i) {
        const SlotPlace pixel = places.place((*slots)[static_cast<std::size_t>(i)]);
        EXPECT_EQ(pixel.row, result.row);
        EXPECT_EQ(pixel.column, result.column + i);
        if (geometry.slots_per_column > 1) {
          EXPECT_EQ(pixel.strip, result.strip);
        }
      }
    }
  }
}

TEST(SlotPlaces, PutTheWordsOfAGroupOfColumnsOneBehindTheOther) {
  const SlotPlaces places(geometry_of(2, fpga::Fetch::kColumn));
  const int rows_of_words[] = {0, 1, 0, 1, 2, 3, 2, 3, 4, 4};  // the last strip has one row inside
  const int columns_of_words[] = {0, 0, 4, 4, 0, 0, 4, 4, 0, 4};
  for (std::uint64_t word = 0; word < 10; ++word) {
    EXPECT_EQ(places.place_of_word(word).row, rows_of_words[word]);
    EXPECT_EQ(places.place_of_word(word).column, columns_of_words[word]);
  }
}

TEST(SlotPlaces, KnowNoSlotOfAPixelThatTheFilterTookFromAnEarlierStrip) {
  platform::BoardConfig board;
  board.image = {8, 5};
  board.matcher.window = 3;  // narrower than the filter
  const SlotPlaces places{fpga::FrameGeometry(platform::core_config(board))};
  EXPECT_EQ(places.slots_of_word(0), std::nullopt);
}

}  // namespace
}  // namespace stereotlm::trace
