#pragma once

#include <cstdint>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/log_filter.h"
#include "models/fpga/lr_check.h"
#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/result_packer.h"
#include "models/fpga/row_buffer.h"
#include "models/fpga/sad_array.h"
#include "models/fpga/select_min_chain.h"
#include "models/fpga/select_min_tree.h"
#include "models/fpga/sequencer.h"

namespace stereotlm::fpga {

// What the stages count in one frame, whenever it runs through them: nothing of it depends on the timing but
// the queue's longest. The slots issued and the words packed are those that the control has come to, so that
// an audit can hold them against the geometry; the rest is known without the frame's cycles from the
// geometry, the pattern of the slots, and the answers.
struct FrameCounts {
  // Of a frame that `control` has run, in which `answered` pixels have a disparity.
  FrameCounts(const CoreConfig& config, const AccessPattern& left, const AccessPattern& right,
              const CoreControl& control, std::uint64_t answered);

  struct Lane {
    Sequencer::Stats slots;
    LutReader::Stats table;
    PixelReader::Stats image;
  };
  Lane left;
  Lane right;
  LogFilter::Stats filter;
  RowBuffer::Stats rows;
  SadArray::Stats sums;
  SelectMinChain::Stats chain;
  SelectMinTree::Stats tree;
  LrCheck::Stats check;
  ResultPacker::Stats packed;
};

}  // namespace stereotlm::fpga
