#pragma once

#include <algorithm>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

// Whether an image of `height` rows has this row.
inline bool is_row_of_image(int row, int height) {
  return static_cast<unsigned>(row) < static_cast<unsigned>(height);
}

// Whether a word of an image begins with this column. On a side without table the columns follow one another,
// so the pixels of all other columns are hits of the word cache (contract 7.4).
inline bool begins_word(int column) { return column % kernels::kPixelsPerWord == 0; }

// The slots of a frame (contract section 2, "Slots" and "Matcher"): strips of columns, and the delay of a
// result behind its slots.
struct FrameGeometry {
  // The configuration has no problems.
  explicit FrameGeometry(const CoreConfig& config);

  int width;              // pixels
  int height;             // pixels
  int radius;             // r
  int half;               // h: half width of the filter and the cost together
  int rows;               // R: rows of results of a strip
  int last_rows;          // rows of results of the last strip that lie inside the image
  int folds;              // S: cycles of the matcher for a consume-cycle
  int lanes;              // P: lanes on each side
  int slots_per_column;   // K: lane p has those with k mod P = p
  int cycles_per_column;  // G: consume-cycles of a column. Number g takes slot gP + p of every lane p
  int lead_strips;        // strips before the first row of results can begin
  int strips;             // of the frame, the leading ones included
  int first_row;      // first row of strip 0; may lie above the image. Each strip begins `rows` further down
  int drain_columns;  // C_d of the contract
  std::uint64_t columns;         // of all strips
  std::uint64_t slots;           // of a side
  std::uint64_t consume_cycles;  // up to the drain, each of `folds` cycles
  std::uint64_t drain_cycles;    // consume-cycles of the drain
  // C of the contract: the results of column i leave with column i + C, both counted over all strips.
  std::uint64_t result_delay_columns;
  std::uint64_t last_strip_column;  // the column with which the first results of the last strip leave
  std::uint64_t result_words;
  int result_delay_cycles;  // Q: from the end of a word's consume-cycle to its entry into the queue

  // The row of the first slot of each column of a strip; may lie outside the image.
  int first_row_of(int strip) const { return first_row + strip * rows; }
  // The strip whose results leave with a column of the matcher; negative before the first.
  std::int64_t result_strip(std::uint64_t column) const {
    const auto behind = static_cast<std::int64_t>(column - result_delay_columns);
    return behind >= 0 ? behind / width : -1 - (-1 - behind) / width;
  }
  // The first row of that strip of results, or of the strip of the slots that a column consumes.
  std::int64_t first_row_at(bool of_results, std::uint64_t column) const {
    if (of_results) return result_strip(column) * rows;
    return first_row_of(std::min(static_cast<int>(column / columns_per_strip()), strips - 1));
  }
  // The slots that a lane has of each column.
  int slots_of_lane(int lane) const { return (slots_per_column - lane + lanes - 1) / lanes; }
  // The slots of a lane that have been consumed after this number of consume-cycles.
  std::uint64_t consumed_slots(int lane, std::uint64_t cycles) const {
    const auto of_column = static_cast<std::uint64_t>(cycles_per_column);
    const auto of_lane = static_cast<std::uint64_t>(slots_of_lane(lane));
    return cycles / of_column * of_lane + std::min(cycles % of_column, of_lane);
  }
  // Whether a row lies inside the image. A slot outside it makes no access, but takes its turn.
  bool is_inside(int row) const { return is_row_of_image(row, height); }
  // The place of a word of results in the buffer. Words are counted in the order in which they leave: a group
  // of four columns has a word for each row of its strip that lies inside the image.
  std::uint64_t place_of_result_word(std::uint64_t word) const {
    const std::uint64_t words_of_row = columns_per_strip() / 4;
    const auto rows_of_strip = static_cast<std::uint64_t>(rows);
    const std::uint64_t strip_row = word / (words_of_row * rows_of_strip) * rows_of_strip;
    const auto rows_inside = static_cast<std::uint64_t>(
        strip_row + rows_of_strip <= static_cast<std::uint64_t>(height) ? rows : last_rows);
    const std::uint64_t in_strip = word - strip_row * words_of_row;
    return (strip_row + in_strip % rows_inside) * words_of_row + in_strip / rows_inside;
  }
  std::uint64_t columns_per_strip() const { return static_cast<std::uint64_t>(width); }  // W
};

// A place in the sequence of the slots of one lane in a frame.
class SlotCursor {
 public:
  SlotCursor() = default;
  // At the first slot of the lane.
  SlotCursor(const FrameGeometry& geometry, int lane);

  bool done() const { return left_ == 0; }  // whether the sequence has ended
  int column() const { return column_; }    // of the slot
  int row() const { return row_; }          // may lie outside the image
  // See FrameGeometry::is_inside().
  bool empty() const { return !is_row_of_image(row(), height_); }

  void advance() {  // to the next slot
    --left_;
    row_ += step_;
    if (++k_ < slots_per_column_) return;
    k_ = 0;
    if (++column_ == width_) {
      column_ = 0;
      strip_row_ += rows_;
    }
    row_ = strip_row_;
  }
  void advance(std::uint64_t slots) {  // by this many slots
    left_ -= slots;
    const std::uint64_t slot = static_cast<std::uint64_t>(k_) + slots;
    const std::uint64_t column =
        static_cast<std::uint64_t>(column_) + slot / static_cast<std::uint64_t>(slots_per_column_);
    k_ = static_cast<int>(slot % static_cast<std::uint64_t>(slots_per_column_));
    column_ = static_cast<int>(column % static_cast<std::uint64_t>(width_));
    const auto strips = static_cast<int>(column / static_cast<std::uint64_t>(width_));
    strip_row_ += strips * rows_;
    row_ = strip_row_ + k_ * step_;
  }

 private:
  int width_ = 0;
  int height_ = 0;
  int slots_per_column_ = 1;
  int step_ = 1;  // rows from a slot of the column to the next one
  int rows_ = 1;
  int strip_row_ = 0;  // row of the first slot of each column of the strip
  int row_ = 0;        // of the slot
  int column_ = 0;
  int k_ = 0;               // slot within the column, counted in this sequence
  std::uint64_t left_ = 0;  // slots from this one to the end
};

}  // namespace stereotlm::fpga
