#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/placement.h"
#include "models/kernels/joint_table.h"
#include "models/memory/word_access.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Reads the table entry of each slot of one lane, at most one per cycle, and passes it to the pixel reader
// (paper section 3.2). A reader of joint tables serves a lane of each side with each word. The control
// decides when a slot comes: one that is not empty comes in the cycle in which its access is granted.
class LutReader : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<LutReader> port{"port"};  // link to the banks
  StreamOut<TableEntry> entries_out{"entries_out"};            // of the left side with joint tables
  // With joint tables: the entries of the right side. Else unbound.
  sc_core::sc_port<StreamIf<TableEntry>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> right_entries_out{
      "right_entries_out"};

 private:
  void take(const Slot& slot) {
    TableEntry left;
    TableEntry right;
    if (!slot.empty) {
      sc_core::sc_time delay = slot.at;
      const std::uint64_t address =
          table_.address(static_cast<std::uint64_t>(slot.row), static_cast<std::uint64_t>(slot.column));
      if (!access_.read(address, delay)) ++errors_;
      left.entry = access_.word();
    }
    if (has_joint_tables_ && !slot.empty) {
      right.entry = kernels::right_entry(left.entry, slot.column, slot.row, offsets_);
      left.entry = kernels::left_entry(left.entry, slot.column, slot.row, offsets_);
    }
    entries_out->push(left);
    if (has_joint_tables_) right_entries_out->push(right);
  }

 public:
  StreamIn<Slot, LutReader, &LutReader::take> slots_in{"slots_in", this};  // of its lane

  // `has_joint_tables`: it reads for both sides.
  LutReader(const sc_core::sc_module_name& name, bool has_joint_tables)
      : sc_module(name), has_joint_tables_(has_joint_tables) {}

  // `offsets`: without effect unless the tables are joint.
  void start_frame(const Placement& table, const kernels::JointOffsets& offsets) {
    table_ = table;
    offsets_ = offsets;
  }
  // The number of refused accesses. Their entries are not valid.
  std::uint64_t errors() const { return errors_; }

 private:
  bool has_joint_tables_;
  Placement table_;
  kernels::JointOffsets offsets_{};
  memory::WordAccess access_{port};
  std::uint64_t errors_ = 0;
};

}  // namespace stereotlm::fpga
