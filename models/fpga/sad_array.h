#pragma once

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/sad_columns.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The array of D column and window modules (paper figures 6 and 8). It takes one column of each side, in
// either order. For the window that ends at these columns it passes on the SAD of every candidate, first to
// select-min unit A, then to unit B. Nothing leaves before the first window is complete.
class SadArray : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t columns = 0;
    std::uint64_t absolute_differences = 0;
    std::uint64_t candidates = 0;  // candidates whose windows lie inside both images
  };

  StreamOut<WindowSums> chain_out{"chain_out"};
  StreamOut<WindowSums> tree_out{"tree_out"};

 private:
  void take_left(const PixelColumn& column);
  void take_right(const PixelColumn& column);

 public:
  StreamIn<PixelColumn, SadArray, &SadArray::take_left> left_in{"left_in", this};
  StreamIn<PixelColumn, SadArray, &SadArray::take_right> right_in{"right_in", this};

  SadArray(const sc_core::sc_module_name& name, const CoreConfig& config);

  void start_frame();
  // Adds the counts of a frame whose data did not pass through this stage.
  void count(const Stats& frame) {
    stats_.columns += frame.columns;
    stats_.absolute_differences += frame.absolute_differences;
    stats_.candidates += frame.candidates;
  }
  const Stats& stats() const { return stats_; }

 private:
  void finish_column();

  FrameGeometry geometry_;
  int window_;
  int disparities_;
  kernels::SadColumns sums_;
  PixelColumn left_;
  PixelColumn right_;
  bool have_left_ = false;
  bool have_right_ = false;
  int columns_before_window_ = 0;  // still to come before the first window is complete
  int column_ = 0;                 // position of the middle of the next window
  int row_ = 0;
  std::uint32_t left_valid_ = 0;  // valid bits of the middle row, newest column lowest
  Stats stats_;
};

}  // namespace stereotlm::fpga
