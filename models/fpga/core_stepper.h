#pragma once

#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/placement.h"
#include "models/fpga/record/conflict_recorder.h"
#include "models/fpga/record/cycle_recorder.h"
#include "models/fpga/record/row_recorder.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Steps the core by one cycle: the control decides, the arbiters grant, the caller moves the data, and the
// control commits what follows from the grants. Plain C++, no SystemC.
class CoreStepper {
 public:
  // `arbitration` outlives this object. Throws std::invalid_argument if the configuration has problems.
  CoreStepper(const CoreConfig& config, memory::Arbitration& arbitration)
      : control_(config), rows_(control_.geometry()), arbitration_(arbitration) {}

  // The ports must be routed before. `placements` must outlive the frame.
  void start_frame(const FrameLatencies& latencies, const Placements& placements) {
    placements_ = &placements;
    control_.start_frame(latencies);
    rows_.start_frame(control_);
  }

  // Runs `cycle`. `host_requests`: whether the host port requests in it. `move` moves the data of the cycle:
  // it is called as move(decision, granted) and returns PixelNeeds. `entry` returns the oldest table entry of
  // a lane whose pixel is not handled: it is called as entry(lane), see CoreControl::lane_index(). Returns
  // the ports granted.
  template <class Move, class Entry>
  memory::PortMask step(std::uint64_t cycle, bool host_requests, const Move& move, const Entry& entry) {
    using memory::PortMask;
    const CoreControl::Decision decision = control_.decide();
    const PortMask host = host_requests ? memory::mask_of(control_.ports().host()) : PortMask{0};
    const PortMask requests = decision.requests | host;
    if (const PortMask placed = decision.requests & arbitration_.placed(); placed != 0) place(placed, entry);
    const PortMask granted = arbitration_.arbitrate(cycle, requests);
    if (cycles_ != nullptr) cycles_->step(cycle, decision, host_requests, granted, control_, arbitration_);
    completed_group_ = control_.commit(decision, granted, move(decision, granted));
    if (host_requests) control_.count_host((granted & host) != 0);
    if (control_.result().words_written() == rows_.next_words()) rows_.note(cycle, control_);
    if (conflicts_ != nullptr) {
      conflicts_->step(requests, granted, arbitration_);
      if (completed_group_) conflicts_->end_group(cycle + 1);
    }
    return granted;
  }
  // Whether the matcher has completed a group of four columns in the last cycle.
  bool completed_group() const { return completed_group_; }

  CoreControl& control() { return control_; }
  const CoreControl& control() const { return control_; }
  RowRecorder& rows() { return rows_; }
  const RowRecorder& rows() const { return rows_; }
  // The recorders of the running frame, or null. The second one receives each stepped cycle.
  void record(ConflictRecorder* conflicts, CycleRecorder* cycles) {
    conflicts_ = conflicts;
    cycles_ = cycles;
  }
  ConflictRecorder* conflicts() const { return conflicts_; }
  CycleRecorder* cycles() const { return cycles_; }
  const Placements& placements() const { return *placements_; }  // of the running frame
  memory::Arbitration& arbitration() { return arbitration_; }
  const memory::Arbitration& arbitration() const { return arbitration_; }

 private:
  // Tells the arbiters the words that these ports request.
  template <class Entry>
  void place(memory::PortMask requests, const Entry& entry) {
    const CorePorts& ports = control_.ports();
    memory::for_each_port(requests, [&](memory::Port port) {
      const Placement& buffer = (*placements_)[ports.group_of(port)];
      const PortGroup& group = ports.group(port);
      std::uint64_t row = 0;
      std::uint64_t number = 0;  // of the word in its row
      if (group.stage == PortStage::kResultWriter) {
        const std::uint64_t place =
            control_.geometry().place_of_result_word(control_.result().words_written());
        row = place / buffer.row_words();
        number = place % buffer.row_words();
      } else {
        const std::size_t lane = control_.lane_index(group.side, ports.lane_of(port));
        const bool reads_entry = group.stage == PortStage::kPixelReader && control_.lane(lane).has_table();
        const std::uint32_t source = reads_entry ? entry(lane) : 0;
        const SlotCursor& slot = control_.lane(lane).next_slot();
        const int column = reads_entry ? kernels::entry_column(source) : slot.column();
        row = static_cast<std::uint64_t>(reads_entry ? kernels::entry_row(source) : slot.row());
        number =
            static_cast<std::uint64_t>(column) / (group.bytes_per_pixel == 4 ? 1 : kernels::kPixelsPerWord);
      }
      const Placement::Word word = buffer.word(row, number);
      arbitration_.place(port, word.bank, word.word);
    });
  }

  CoreControl control_;
  RowRecorder rows_;
  memory::Arbitration& arbitration_;
  const Placements* placements_ = nullptr;  // of the running frame
  ConflictRecorder* conflicts_ = nullptr;
  CycleRecorder* cycles_ = nullptr;
  bool completed_group_ = false;
};

}  // namespace stereotlm::fpga
