#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/lr_check.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The left-right check (paper section 2.3; contract 1.4). For each column it takes the matches of unit A and
// unit B, in either order. It passes on the checked disparity of the left pixel D-1 columns back, from the
// first pixel of the frame on. Each of the R rows has a check of its own; rows outside the image end here.
class LrCheck : public sc_core::sc_module {
 public:
  StreamOut<Disparity> disparities_out{"disparities_out"};

 private:
  void take_right(const RightMatch& match);
  void take_left(const LeftMatch& match);

 public:
  StreamIn<RightMatch, LrCheck, &LrCheck::take_right> right_in{"right_in", this};
  StreamIn<LeftMatch, LrCheck, &LrCheck::take_left> left_in{"left_in", this};

  LrCheck(const sc_core::sc_module_name& name, const CoreConfig& config);

  void start_frame();

 private:
  struct Row {
    kernels::LrCheck check;
    RightMatch right{};
    LeftMatch left{};
    bool have_right = false;
    bool have_left = false;
  };

  void finish_column(Row& row);
  void next_column();

  FrameGeometry geometry_;
  std::vector<Row> rows_;  // [row of a strip]; for each column, the matches of the rows come in this order
  std::uint64_t columns_to_skip_ = 0;
  int column_ = 0;     // column of the next results
  int first_row_ = 0;  // first row of the next results
};

}  // namespace stereotlm::fpga
