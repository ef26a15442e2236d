#include "models/fpga/lut_reader.h"

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

LutReader::LutReader(const sc_core::sc_module_name& name, int width, bool has_joint_tables)
    : sc_module(name), width_(static_cast<std::uint64_t>(width)), has_joint_tables_(has_joint_tables) {}

void LutReader::take(const Slot& slot) {
  if (slot.empty) {
    push({}, {});
    return;
  }
  const std::uint64_t pixel =
      static_cast<std::uint64_t>(slot.row) * width_ + static_cast<std::uint64_t>(slot.column);
  sc_core::sc_time delay = slot.at;
  if (!access_.read(table_address_ + entry_offset(pixel), delay)) ++errors_;
  const std::uint32_t word = access_.word();
  TableEntry left{word};
  TableEntry right;
  if (has_joint_tables_) {
    left.entry = kernels::left_entry(word, slot.column, slot.row, offsets_);
    right.entry = kernels::right_entry(word, slot.column, slot.row, offsets_);
  }
  push(left, right);
}

void LutReader::push(const TableEntry& left, const TableEntry& right) {
  entries_out->push(left);
  if (has_joint_tables_) right_entries_out->push(right);
}

}  // namespace stereotlm::fpga
