#include "models/fpga/lut_reader.h"

#include "models/kernels/rectification_table.h"

namespace stereotlm::fpga {

LutReader::LutReader(const sc_core::sc_module_name& name, int width)
    : sc_module(name), width_(static_cast<std::uint64_t>(width)) {}

void LutReader::take(const Slot& slot) {
  TableEntry entry;
  if (slot.empty) {
    ++stats_.empty_slots;
  } else {
    const std::uint64_t pixel =
        static_cast<std::uint64_t>(slot.row) * width_ + static_cast<std::uint64_t>(slot.column);
    sc_core::sc_time delay = slot.at;
    if (!access_.read(table_address_ + pixel * 4, delay)) ++stats_.errors;
    ++stats_.reads;
    entry.entry = access_.word();
    stats_.invalid_entries += std::uint64_t{!kernels::entry_is_valid(entry.entry)};
  }
  entry_valid_ = kernels::entry_is_valid(entry.entry);
  entries_out->push(entry);
}

}  // namespace stereotlm::fpga
