// The stages from the sequence of slots to columns of pixels, each alone.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "models/fpga/log_filter.h"
#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/row_buffer.h"
#include "models/fpga/sequencer.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/ssram_bank.h"
#include "tests/support/expected_report.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using sc_core::sc_time;
using test::ExpectedReport;

const sc_time kAt(75, sc_core::SC_NS);

void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }

// Puts words into a bank through the socket of the stage under test.
template <class Socket>
void preload(Socket& socket, std::uint64_t address, std::vector<std::uint32_t> words) {
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  payload.set_address(address);
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  payload.set_data_length(static_cast<unsigned>(words.size() * 4));
  ASSERT_EQ(socket->transport_dbg(payload), words.size() * 4);
}

TEST(Sequencer, SendsEachSideItsSlots) {
  CoreConfig config;
  config.width = 4;
  config.height = 2;
  config.window = 3;
  config.filter.reset();
  Sequencer sequencer("sequencer");
  Collected<Slot> left;
  Collected<Slot> right;
  sequencer.left_out.bind(left);
  sequencer.right_out.bind(right);
  elaborate();
  SlotCursor place{FrameGeometry(config)};
  for (; !place.done(); place.advance()) sequencer.issue(Side::kLeft, place, kAt);
  sequencer.issue(Side::kRight, SlotCursor{FrameGeometry(config)}, sc_time());
  ASSERT_EQ(left.beats.size(), 24U);
  ASSERT_EQ(right.beats.size(), 1U);
  std::uint64_t empty = 0;
  for (int slot = 0; slot < 24; ++slot) {
    const Slot& beat = left.beats[static_cast<std::size_t>(slot)];
    EXPECT_EQ(beat.column, slot % 12 / 3);
    EXPECT_EQ(beat.row, slot / 12 - 1 + slot % 3);
    EXPECT_EQ(beat.empty, beat.row < 0 || beat.row > 1);
    EXPECT_EQ(beat.at, kAt);
    empty += std::uint64_t{beat.empty};
  }
  EXPECT_EQ(sequencer.stats(Side::kLeft).slots, 24U);
  EXPECT_EQ(sequencer.stats(Side::kLeft).empty_slots, empty);
  EXPECT_EQ(empty, 8U);
  EXPECT_EQ(right.beats.front().column, 0);
  EXPECT_EQ(right.beats.front().row, -1);
  EXPECT_EQ(right.beats.front().at, sc_time());
  EXPECT_EQ(sequencer.stats(Side::kRight).slots, 1U);
  EXPECT_EQ(sequencer.stats(Side::kRight).empty_slots, 1U);
}

class LutReaderTest : public testing::Test {
 protected:
  LutReaderTest() {
    binder.bind(reader.port, bank.port, "left_lut_to_bank");
    reader.entries_out.bind(entries);
    elaborate();
  }
  test::MonitoringBinder binder;
  memory::SsramBank bank{"bank", {32}};
  LutReader reader{"left_lut", 8};
  Collected<TableEntry> entries;
};

TEST_F(LutReaderTest, ReadsTheEntryOfTheSlotFromItsTable) {
  const std::uint32_t valid = kernels::make_entry(5, 1);
  const std::uint32_t invalid = 0;
  preload(reader.port, 4 * 4 + (8 + 3) * 4, {valid, invalid});
  reader.start_frame(16);
  reader.slots_in->push({3, 1, false, kAt});
  EXPECT_TRUE(reader.entry_valid());
  reader.slots_in->push({4, 1, false, kAt});
  EXPECT_FALSE(reader.entry_valid());
  ASSERT_EQ(entries.beats.size(), 2U);
  EXPECT_EQ(entries.beats[0].entry, valid);
  EXPECT_EQ(entries.beats[1].entry, invalid);
  EXPECT_EQ(reader.stats().reads, 2U);
  EXPECT_EQ(reader.stats().invalid_entries, 1U);
  EXPECT_EQ(bank.stats().reads, 2U);
}

TEST_F(LutReaderTest, HandsOnAnEmptySlotWithoutAccess) {
  preload(reader.port, 0, {kernels::make_entry(0, 0)});
  reader.start_frame(0);
  reader.slots_in->push({0, 0, false, kAt});
  ASSERT_TRUE(reader.entry_valid());
  reader.slots_in->push({0, -1, true, kAt});
  EXPECT_FALSE(reader.entry_valid());
  EXPECT_EQ(entries.beats.back().entry, 0U);
  EXPECT_EQ(reader.stats().empty_slots, 1U);
  EXPECT_EQ(reader.stats().reads, 1U);
  EXPECT_EQ(bank.stats().reads, 1U);
}

TEST_F(LutReaderTest, TakesARefusedAccessForAnEntryThatIsNotValid) {
  reader.start_frame(0);
  reader.slots_in->push({7, 3, false, kAt});  // the last word of the bank
  EXPECT_EQ(reader.stats().errors, 0U);
  reader.slots_in->push({0, 4, false, kAt});
  EXPECT_EQ(reader.stats().errors, 1U);
  EXPECT_EQ(entries.beats.back().entry, 0U);
  EXPECT_FALSE(reader.entry_valid());
}

class PixelReaderTest : public testing::Test {
 protected:
  PixelReaderTest() {
    binder.bind(reader.port, bank.port, "left_pixel_to_bank");
    reader.pixels_out.bind(pixels);
    elaborate();
    // 8 x 4 pixels of value 10 * row + column, from word 2 on.
    std::vector<std::uint32_t> words;
    for (std::uint32_t row = 0; row < 4; ++row) {
      for (std::uint32_t column = 0; column < 8; column += 4)
        words.push_back(0x0302'0100U + 0x0101'0101U * (10 * row + column));
    }
    preload(reader.port, 8, words);
    reader.start_frame(8);
  }
  void expect_pixel(std::uint8_t value, bool valid) {
    reader.release();
    EXPECT_EQ(pixels.beats.back().value, value);
    EXPECT_EQ(pixels.beats.back().valid, valid);
  }
  test::MonitoringBinder binder;
  memory::SsramBank bank{"bank", {10}};
  PixelReader reader{"left_pixel", 8};
  Collected<MaskedPixel> pixels;
};

TEST_F(PixelReaderTest, ReadsWhereTheEntryPoints) {
  reader.entries_in->push({kernels::make_entry(3, 2)});
  reader.entries_in->push({kernels::make_entry(4, 0)});
  EXPECT_EQ(bank.stats().reads, 0U);
  reader.handle(kAt);
  reader.handle(kAt);
  EXPECT_EQ(bank.stats().reads, 2U);
  expect_pixel(23, true);
  expect_pixel(4, true);
  EXPECT_EQ(reader.stats().reads, 2U);
  EXPECT_EQ(reader.stats().passed_slots, 0U);
}

TEST_F(PixelReaderTest, PassesAnEntryThatIsNotValidWithoutAccess) {
  reader.entries_in->push({kernels::make_entry(3, 2) & ~kernels::kEntryValid});
  reader.handle(kAt);
  expect_pixel(0, false);
  EXPECT_EQ(reader.stats().passed_slots, 1U);
  EXPECT_EQ(bank.stats().reads, 0U);
}

TEST_F(PixelReaderTest, ReadsSlotsByThemselvesOnASideWithoutTable) {
  reader.slots_in->push({7, 3, false, kAt});
  reader.slots_in->push({7, 4, true, kAt});
  expect_pixel(37, true);
  expect_pixel(0, false);
  EXPECT_EQ(bank.stats().reads, 1U);
  EXPECT_EQ(reader.stats().passed_slots, 1U);
}

TEST_F(PixelReaderTest, KeepsAFullLaneInOrder) {
  for (int slot = 0; slot < 64; ++slot)
    reader.entries_in->push({kernels::make_entry(slot % 8, slot / 8 % 4)});
  for (int slot = 0; slot < 64; ++slot) reader.handle(kAt);
  for (int slot = 0; slot < 64; ++slot)
    expect_pixel(static_cast<std::uint8_t>(slot / 8 % 4 * 10 + slot % 8), true);
}

TEST_F(PixelReaderTest, ReadsZeroWhereAnAccessIsRefused) {
  reader.start_frame(36);  // one word before the end of the bank
  reader.slots_in->push({3, 0, false, kAt});
  EXPECT_EQ(reader.stats().errors, 0U);
  reader.slots_in->push({4, 0, false, kAt});
  EXPECT_EQ(reader.stats().errors, 1U);
  expect_pixel(37, true);
  expect_pixel(0, true);
}

TEST_F(PixelReaderTest, ReleasesBlanksInTheDrain) {
  reader.release_blank();
  EXPECT_EQ(pixels.beats.back().value, 0);
  EXPECT_FALSE(pixels.beats.back().valid);
}

TEST_F(PixelReaderTest, ReportsWhatTheControlMayNotAskFor) {
  {
    ExpectedReport report("/stereotlm/pixel_reader");
    EXPECT_THROW(reader.handle(kAt), sc_core::sc_report);
  }
  ExpectedReport report("/stereotlm/pixel_reader");
  EXPECT_THROW(reader.release(), sc_core::sc_report);
}

TEST_F(PixelReaderTest, ForgetsTheLastFrame) {
  reader.entries_in->push({kernels::make_entry(0, 0)});
  reader.start_frame(8);
  ExpectedReport report("/stereotlm/pixel_reader");
  EXPECT_THROW(reader.handle(kAt), sc_core::sc_report);
}

// An image through the filter, in the order of the slots.
class LogFilterTest : public testing::Test {
 protected:
  void run(const CoreConfig& core) {
    config = core;
    filter = std::make_unique<LogFilter>("filter", config);
    filter->columns_out.bind(columns);
    elaborate();
    image = noise(static_cast<std::size_t>(config.width * config.height), 7);
    const FrameGeometry geometry(config);
    for (int frame = 0; frame < 2; ++frame) {
      columns.beats.clear();
      filter->start_frame();
      for (SlotCursor slot(geometry); !slot.done(); slot.advance())
        filter->pixels_in->push(slot.empty() ? MaskedPixel{} : pixel(slot.column(), slot.row()));
      for (std::uint64_t cycle = 0; cycle < geometry.drain_cycles; ++cycle)
        filter->pixels_in->push(MaskedPixel{});
      check(geometry);
    }
    EXPECT_EQ(filter->stats().pixels, 2 * (geometry.slots + geometry.drain_cycles));
    EXPECT_EQ(filter->stats().columns,
              filter->stats().pixels / static_cast<std::uint64_t>(geometry.slots_per_column));
  }

  MaskedPixel pixel(int column, int row) const {
    return {image[static_cast<std::size_t>(row * config.width + column)], (column + row) % 3 != 0};
  }

  // The column that leaves with column number c is that of h columns before, h rows further up.
  void check(const FrameGeometry& geometry) const {
    std::optional<test::ReferenceKernel> kernel;
    if (config.filter) kernel = {config.filter->size, config.filter->weights, config.filter->shift};
    const auto expected = test::reference_filter(config.width, config.height, image, kernel);
    const int h = geometry.filter_half;
    int checked = 0;
    for (int number = h; number < static_cast<int>(columns.beats.size()); ++number) {
      const PixelColumn& column = columns.beats[static_cast<std::size_t>(number)];
      const int u = (number - h) % config.width;
      const int first_row = geometry.first_row - h + (number - h) / config.width;
      for (int k = 0; k < geometry.slots_per_column; ++k) {
        const int row = first_row + k;
        if (row < 0 || row >= config.height || (number - h) / config.width >= geometry.strips) continue;
        EXPECT_EQ(column.values[static_cast<std::size_t>(k)],
                  expected[static_cast<std::size_t>(row * config.width + u)])
            << u << ' ' << row;
        EXPECT_EQ(column.valid >> k & 1U, unsigned{pixel(u, row).valid}) << u << ' ' << row;
        ++checked;
      }
    }
    EXPECT_GE(checked, config.width * config.height);
  }

  CoreConfig config;
  std::vector<std::uint8_t> image;
  std::unique_ptr<LogFilter> filter;
  Collected<PixelColumn> columns;
};

CoreConfig filter_board(int window, std::optional<kernels::FilterKernel> kernel, Fetch fetch) {
  CoreConfig config;
  config.width = 12;
  config.height = 9;
  config.window = window;
  config.disparities = 2;
  config.filter = std::move(kernel);
  config.fetch = fetch;
  return config;
}

TEST_F(LogFilterTest, FiltersColumnsOfTheWindowsHeight) {
  run(filter_board(7, kernels::log7(), Fetch::kColumn));
}
TEST_F(LogFilterTest, FiltersWithAKernelLargerThanTheWindow) {
  run(filter_board(3, kernels::log7(), Fetch::kColumn));
}
TEST_F(LogFilterTest, FiltersWithAKernelSmallerThanTheWindow) {
  run(filter_board(9, kernels::FilterKernel{3, {0, -1, 0, -1, 4, -1, 0, -1, 0}, 1}, Fetch::kColumn));
}
TEST_F(LogFilterTest, FiltersPixelByPixel) { run(filter_board(7, kernels::log7(), Fetch::kLineBuffer)); }
TEST_F(LogFilterTest, CollectsColumnsWithoutFilter) { run(filter_board(5, std::nullopt, Fetch::kColumn)); }
TEST_F(LogFilterTest, HandsOnPixelsWithoutFilter) { run(filter_board(5, std::nullopt, Fetch::kLineBuffer)); }
TEST_F(LogFilterTest, FiltersAnImageOfOneRow) {
  CoreConfig config_of_row = filter_board(3, kernels::log7(), Fetch::kColumn);
  config_of_row.height = 1;
  run(config_of_row);
}

TEST(RowBuffer, MakesAColumnOfTheLastRows) {
  constexpr int kWidth = 4;
  constexpr int kWindow = 3;
  RowBuffer rows("rows", kWidth, kWindow);
  Collected<PixelColumn> columns;
  rows.columns_out.bind(columns);
  elaborate();
  const auto value = [](int column, int row) { return static_cast<std::uint8_t>(10 * row + column); };
  const auto valid = [](int column, int row) { return (column + row) % 2 == 0; };
  for (int frame = 0; frame < 2; ++frame) {
    columns.beats.clear();
    rows.start_frame();
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        PixelColumn pixel;
        pixel.values[0] = value(column, row);
        pixel.valid = unsigned{valid(column, row)};
        rows.columns_in->push(pixel);
        const PixelColumn& out = columns.beats.back();
        for (int k = 0; k < kWindow; ++k) {
          const int of_row = row - (kWindow - 1) + k;
          if (of_row < 0) continue;
          EXPECT_EQ(out.values[static_cast<std::size_t>(k)], value(column, of_row));
          EXPECT_EQ(out.valid >> k & 1U, unsigned{valid(column, of_row)});
        }
      }
    }
    EXPECT_EQ(columns.beats.size(), 20U);
  }
  EXPECT_EQ(rows.stats().columns, 40U);
}

TEST(RowBuffer, BeginsAFrameAtTheFirstColumn) {
  RowBuffer rows("rows", 4, 3);
  Collected<PixelColumn> columns;
  rows.columns_out.bind(columns);
  elaborate();
  PixelColumn pixel;
  pixel.values[0] = 99;
  rows.start_frame();
  rows.columns_in->push(pixel);
  rows.start_frame();
  pixel.values[0] = 1;
  rows.columns_in->push(pixel);
  EXPECT_EQ(columns.beats.back().values[1], 99);
  EXPECT_EQ(columns.beats.back().values[2], 1);
}

}  // namespace
}  // namespace stereotlm::fpga
