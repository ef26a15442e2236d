#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/memory/word_access.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Reads the table entry of each slot of one side, at most one a cycle, and passes it to the pixel reader
// (paper section 3.2). The control decides when a slot comes: one that is not empty comes in the cycle in
// which its access is granted.
class LutReader : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t reads = 0;
    std::uint64_t invalid_entries = 0;  // of the entries read
    std::uint64_t empty_slots = 0;
    std::uint64_t errors = 0;  // refused accesses; the entry then counts as not valid
  };

  tlm_utils::simple_initiator_socket<LutReader> port{"port"};
  StreamOut<TableEntry> entries_out{"entries_out"};

 private:
  void take(const Slot& slot);

 public:
  StreamIn<Slot, LutReader, &LutReader::take> slots_in{"slots_in", this};

  // `width`: pixels of a row of the image.
  LutReader(const sc_core::sc_module_name& name, int width);

  // `table_address`: byte address on the port.
  void start_frame(std::uint64_t table_address) { table_address_ = table_address; }
  // The table of width * height entries, for immediate use only; null if memory does not grant direct access.
  const std::uint32_t* table(int height);
  // Adds the counts of a frame whose table was read directly.
  void count(const Stats& frame);
  // Whether the entry of the last slot is valid.
  bool entry_valid() const { return entry_valid_; }
  const Stats& stats() const { return stats_; }

 private:
  std::uint64_t width_;
  std::uint64_t table_address_ = 0;
  memory::WordAccess access_{port};
  bool entry_valid_ = false;
  Stats stats_;
};

}  // namespace stereotlm::fpga
