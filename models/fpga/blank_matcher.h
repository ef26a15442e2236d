#pragma once

#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Stands for the filter and the matcher in simulations without pixels: takes the pixels of both sides, and
// passes on matches without meaning, in the cycles in which select-min units A and B would.
class BlankMatcher : public sc_core::sc_module {
 public:
  StreamOut<RightMatch> right_matches_out{"right_matches_out"};
  StreamOut<LeftMatch> left_matches_out{"left_matches_out"};

 private:
  void take_left(const MaskedPixel& /*pixel*/) {}
  // The pixels of the right side come last in each cycle.
  void take_right(const MaskedPixel& /*pixel*/) {
    if (++slots_ < geometry_.slots_per_column) return;
    slots_ = 0;
    if (columns_before_window_ > 0) {
      --columns_before_window_;
      return;
    }
    for (int row = 0; row < geometry_.rows; ++row) {
      right_matches_out->push({row, 0});
      left_matches_out->push({row, 0, true});
    }
  }

 public:
  StreamIn<MaskedPixel, BlankMatcher, &BlankMatcher::take_left> left_in{"left_in", this};
  StreamIn<MaskedPixel, BlankMatcher, &BlankMatcher::take_right> right_in{"right_in", this};

  BlankMatcher(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name), geometry_(config) {}

  void start_frame() {
    slots_ = 0;
    columns_before_window_ = geometry_.half + geometry_.radius;
  }

 private:
  FrameGeometry geometry_;
  int slots_ = 0;                  // pixels of the column that have come
  int columns_before_window_ = 0;  // columns before the first complete window
};

}  // namespace stereotlm::fpga
