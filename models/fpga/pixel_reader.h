#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/memory/word_access.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Reads the source pixel of each slot of one side, at most one a cycle, in order, and holds it until the
// matcher consumes it. With a table, an entry from the LUT reader waits until handle() is called. Without a
// table, the pixel of a slot from the sequencer is read as soon as the slot arrives. CoreControl decides in
// which cycle a pixel is read, and in which cycle release() is called.
class PixelReader : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t reads = 0;
    std::uint64_t passed_slots = 0;  // slots without access: empty, or without valid entry
    std::uint64_t errors = 0;        // refused accesses; the pixel is then 0
  };

  tlm_utils::simple_initiator_socket<PixelReader> port{"port"};
  StreamOut<MaskedPixel> pixels_out{"pixels_out"};

 private:
  void store_entry(const TableEntry& entry);
  void take(const Slot& slot);

 public:
  StreamIn<TableEntry, PixelReader, &PixelReader::store_entry> entries_in{"entries_in", this};
  StreamIn<Slot, PixelReader, &PixelReader::take> slots_in{"slots_in", this};

  // `width`: pixels of a row of the image.
  PixelReader(const sc_core::sc_module_name& name, int width);

  // `image_address`: byte address on the port.
  void start_frame(std::uint64_t image_address);
  // Reads or passes the oldest waiting entry, in the cycle that is `at` from now.
  void handle(const sc_core::sc_time& at);
  // Passes on the oldest pixel, which the matcher consumes.
  void release() {
    if (pixels_released_ == pixels_stored_) {
      SC_REPORT_ERROR("/stereotlm/pixel_reader", "release: no pixel waits");
      return;
    }
    pixels_out->push(pixels_[pixels_released_++ % kRing]);
  }
  // Passes on a pixel that no result depends on. To be called in each cycle of the drain.
  void release_blank() { pixels_out->push(MaskedPixel{}); }
  // The image of width * height pixels, for immediate use only; null if memory does not grant direct access.
  const std::uint8_t* image(int height);
  // Adds the counts of a frame whose image was read directly.
  void count(const Stats& frame);
  const Stats& stats() const { return stats_; }

 private:
  static constexpr std::size_t kRing = kLaneFifoRule.max;

  void read(std::uint64_t column, std::uint64_t row, const sc_core::sc_time& at);
  void pass();

  std::uint64_t width_;
  std::uint64_t image_address_ = 0;
  memory::WordAccess access_{port};
  std::array<TableEntry, kRing> entries_{};
  std::array<MaskedPixel, kRing> pixels_{};
  // Numbers of entries and pixels since the start of the frame.
  std::size_t entries_stored_ = 0;
  std::size_t entries_handled_ = 0;
  std::size_t pixels_stored_ = 0;
  std::size_t pixels_released_ = 0;
  Stats stats_;
};

}  // namespace stereotlm::fpga
