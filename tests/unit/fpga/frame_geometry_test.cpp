#include "models/fpga/frame_geometry.h"

#include <gtest/gtest.h>

#include <vector>

namespace stereotlm::fpga {
namespace {

struct Position {
  int column;
  int row;
  friend bool operator==(const Position& a, const Position& b) {
    return a.column == b.column && a.row == b.row;
  }
};

kernels::FilterKernel zero_kernel(int size) {
  return {size, std::vector<int>(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)), 0};
}

// `filter_size` 0: no filter.
CoreConfig board(int width, int height, int window, int filter_size, Fetch fetch) {
  CoreConfig config;
  config.width = width;
  config.height = height;
  config.window = window;
  config.disparities = 5;
  config.filter.reset();
  if (filter_size > 0) config.filter = zero_kernel(filter_size);
  config.fetch = fetch;
  return config;
}

// Contract section 2, "Slots", as it stands there.
std::vector<Position> slots_of(const CoreConfig& config) {
  const int n = config.window;
  const int r = (n - 1) / 2;
  const int h = config.filter ? (config.filter->size - 1) / 2 : 0;
  std::vector<Position> slots;
  if (config.fetch == Fetch::kColumn) {
    const int w = std::max(0, h - r);
    for (int v = -w; v <= config.height - 1; ++v) {
      for (int u = 0; u < config.width; ++u) {
        for (int k = 0; k < n; ++k) slots.push_back({u, v + h - r + k});
      }
    }
  } else {
    for (int y = 0; y <= config.height + r + h - 1; ++y) {
      for (int u = 0; u < config.width; ++u) slots.push_back({u, y});
    }
  }
  return slots;
}

std::vector<CoreConfig> boards() {
  return {board(4, 3, 3, 0, Fetch::kColumn),     board(8, 5, 5, 3, Fetch::kColumn),
          board(4, 6, 3, 7, Fetch::kColumn),     board(4, 1, 3, 0, Fetch::kColumn),
          board(4, 1, 7, 31, Fetch::kColumn),    board(4, 2, 31, 0, Fetch::kColumn),
          board(4, 3, 3, 0, Fetch::kLineBuffer), board(8, 5, 5, 7, Fetch::kLineBuffer),
          board(4, 1, 3, 31, Fetch::kLineBuffer)};
}

TEST(SlotCursor, WalksTheSequenceOfTheContract) {
  for (const CoreConfig& config : boards()) {
    const FrameGeometry geometry(config);
    SlotCursor cursor(geometry);
    const std::vector<Position> slots = slots_of(config);
    ASSERT_EQ(geometry.slots, slots.size());
    for (const Position& slot : slots) {
      ASSERT_FALSE(cursor.done());
      EXPECT_EQ((Position{cursor.column(), cursor.row()}), slot);
      EXPECT_EQ(cursor.empty(), slot.row < 0 || slot.row >= config.height);
      cursor.advance();
    }
    EXPECT_TRUE(cursor.done());
  }
}

TEST(FrameGeometry, HoldsResultsBackByTheColumnsOfTheContract) {
  for (const CoreConfig& config : boards()) {
    const FrameGeometry geometry(config);
    const int r = (config.window - 1) / 2;
    const int h = config.filter ? (config.filter->size - 1) / 2 : 0;
    const int drain = config.disparities - 1 + r + h;
    const bool column = config.fetch == Fetch::kColumn;
    const int lead = column ? std::max(0, h - r) : r + h;
    EXPECT_EQ(geometry.drain_columns, drain);
    EXPECT_EQ(geometry.drain_cycles, static_cast<std::uint64_t>(drain * (column ? config.window : 1)));
    EXPECT_EQ(geometry.result_delay_columns, static_cast<std::uint64_t>(drain + lead * config.width));
    EXPECT_EQ(geometry.result_words, static_cast<std::uint64_t>(config.width * config.height / 4));
    // The last result leaves with the last column of the drain.
    const std::uint64_t columns =
        (geometry.slots + geometry.drain_cycles) / static_cast<std::uint64_t>(geometry.slots_per_column);
    EXPECT_EQ(columns, geometry.result_delay_columns + geometry.result_words * 4);
  }
}

}  // namespace
}  // namespace stereotlm::fpga
