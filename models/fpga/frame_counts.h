#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "models/fpga/access_pattern.h"
#include "models/fpga/census.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/cost_array.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/log_filter.h"
#include "models/fpga/lr_check.h"
#include "models/fpga/lut_reader.h"
#include "models/fpga/pixel_reader.h"
#include "models/fpga/result_packer.h"
#include "models/fpga/result_writer.h"
#include "models/fpga/row_buffer.h"
#include "models/fpga/select_min_chain.h"
#include "models/fpga/select_min_tree.h"
#include "models/fpga/sequencer.h"

namespace stereotlm::fpga {

// Computes what the stages would have counted in a frame that worked directly on memory, whose data they did
// not move. The slots issued and the words packed and written are taken from the control, so that an audit
// can compare them with the geometry. All other counts follow from the geometry, the accesses of the slots
// and the number of disparities.
//
// With several rows at once a column is counted once for all rows of its strip, and the costs of pixel pairs
// that the rows share are counted once. Candidates, matches and disparities are counted for each row.
struct FrameCounts {
  // `run` has run the frame up to its last write. `answered`: the number of pixels that have a disparity;
  // nothing if no disparities were computed.
  FrameCounts(const CoreConfig& config, const AccessPatterns& patterns, const FrameRun& run,
              std::optional<std::uint64_t> answered);

  struct Lane {
    Sequencer::Stats slots;
    LutReader::Stats table;
    PixelReader::Stats image;
  };
  std::array<Lane, 2> lanes;  // [side]
  LogFilter::Stats filter;
  Census::Stats census;
  RowBuffer::Stats rows;
  CostArray::Stats sums;
  SelectMinChain::Stats chain;
  SelectMinTree::Stats tree;
  std::optional<LrCheck::Stats> check;  // nothing if no disparities were computed
  ResultPacker::Stats packed;
  ResultWriter::Stats result;
  std::array<std::uint64_t, kCorePortCount> accesses{};  // [port]: accesses to the banks
};

}  // namespace stereotlm::fpga
