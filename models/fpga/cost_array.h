#pragma once

#include <cstdint>
#include <optional>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/column_scores.h"
#include "models/kernels/cost_columns.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The array of column and window modules (paper figures 6 and 8). It takes a column of the left side, then
// one of the right side. For the windows that end at these columns it passes on the sum or the score of every
// candidate: row by row, first to select-min unit A, then to unit B. Nothing leaves before the first window
// is complete. The number of modules has no effect here: all candidates are computed when the last fold ends.
class CostArray : public sc_core::sc_module {
 public:
  StreamOut<WindowSums> chain_out{"chain_out"};  // to unit A
  StreamOut<WindowSums> tree_out{"tree_out"};    // to unit B

 private:
  void take_left(const PixelColumn& column) { left_ = column; }
  void take_right(const PixelColumn& column);

 public:
  // A column of the left side, then one of the right side.
  StreamIn<PixelColumn, CostArray, &CostArray::take_left> left_in{"left_in", this};
  StreamIn<PixelColumn, CostArray, &CostArray::take_right> right_in{"right_in", this};

  // The configuration has no problems.
  CostArray(const sc_core::sc_module_name& name, const CoreConfig& config);

  void start_frame();  // to be called before the first column of a frame

 private:
  struct Row {
    kernels::CostColumns sums;
    std::optional<kernels::ColumnScorer> scorer;
    std::uint32_t left_valid = 0;  // valid bits of the middle row of the window, newest column lowest
  };

  void pass_on(int index, const Row& row);

  FrameGeometry geometry_;
  int window_;
  int disparities_;
  int pixel_bytes_;
  std::vector<Row> rows_;
  PixelColumn left_;
  int columns_before_window_ = 0;  // still to come before the first windows are complete
  int column_ = 0;                 // position of the middle of the next windows
  int first_row_ = 0;              // row of the middle of the first of the R windows
};

}  // namespace stereotlm::fpga
