#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include "models/binder.h"
#include "models/fpga/blank_matcher.h"
#include "models/fpga/census.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/cost_array.h"
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
#include "models/memory/crossbar.h"

namespace stereotlm::fpga {

// Holds the stages of the core, and binds the streams between them (paper figures 5 and 6). The stages reach
// memory through the crossbar's sockets. They are children of the module that holds this object, which is
// StereoCore.
class CoreDatapath {
 public:
  // The stages that read, in one lane.
  struct Readers {
    std::unique_ptr<LutReader> lut;  // null if the side has no table, or the left one reads for both
    std::unique_ptr<PixelReader> pixel;
  };
  // The stages of one side, up to the matcher.
  struct SideStages {
    SideStages(const CoreConfig& config, Side side);

    bool has_table;
    std::vector<Readers> lanes;
    LogFilter filter;
    std::unique_ptr<Census> census;         // null unless the cost is kCensus
    std::unique_ptr<RowBuffer> row_buffer;  // null unless the fetch is kLineBuffer
  };

  // `has_pixels`: whether disparities are computed. `binder` binds the stages to the crossbar, which outlives
  // this object.
  CoreDatapath(const CoreConfig& config, bool has_pixels, memory::Crossbar& crossbar, Binder& binder);

  // Starts a frame on these buffers, whose banks must exist. `offsets`: without effect unless the tables are
  // joint.
  void start_frame(const FrameBases& bases, const kernels::JointOffsets& offsets);
  // Moves the data of one cycle, which begins `at` from now. `control` must be in the state in which it
  // decided, before commit().
  PixelNeeds move(const CoreControl& control, const CoreControl::Decision& decision, memory::PortMask granted,
                  const sc_core::sc_time& at);
  // See PixelReader.
  std::uint32_t next_entry(std::size_t lane) const { return pixel_readers_[lane]->next_entry(); }
  // The number of accesses that memory has refused, over all frames.
  std::uint64_t errors() const;

  // The stages, for their statistics.
  const Sequencer& sequencer() const { return sequencer_; }
  const ResultPacker& result_packer() const { return result_packer_; }
  const ResultWriter& result_writer() const { return result_writer_; }

 private:
  template <std::size_t kLanes>
  PixelNeeds move_lanes(const CoreControl& control, const CoreControl::Decision& decision,
                        memory::PortMask granted, const sc_core::sc_time& at);
  void bind_memory(Binder& binder);
  void bind_streams();
  void issue(std::size_t lane, const CoreControl& control, const sc_core::sc_time& at) {
    const SlotCursor& slot = control.lane(lane).next_slot();
    config_.joint_tables ? sequencer_.issue_to_both(lane, slot, at) : sequencer_.issue(lane, slot, at);
  }

  CoreConfig config_;
  memory::Crossbar& crossbar_;
  CorePorts ports_;
  Sequencer sequencer_{"sequencer", ports_.lanes()};
  std::array<SideStages, 2> sides_{SideStages(config_, Side::kLeft), SideStages(config_, Side::kRight)};
  std::vector<PixelReader*> pixel_readers_;  // [lane]: CoreControl::lanes()
  CostArray cost_array_{"cost_array", config_};
  SelectMinChain select_min_chain_{"select_min_chain", config_};
  SelectMinTree select_min_tree_{"select_min_tree"};
  std::unique_ptr<BlankMatcher> blank_matcher_;  // null if there are pixels
  LrCheck lr_check_{"lr_check", config_};
  ResultPacker result_packer_{"result_packer", config_};
  ResultWriter result_writer_{"result_writer", config_.result_fifo_words};
};

}  // namespace stereotlm::fpga
