#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"
#include "models/memory/word_access.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Reads the source pixel of each slot of one lane, at most one per cycle, in order, and holds it until the
// matcher consumes it. With a table, an entry from the LUT reader waits until handle() is called. Without a
// table, the pixel of a slot from the sequencer is read as soon as the slot arrives. CoreControl decides in
// which cycle a pixel is read, and in which cycle release() is called.
//
// With the word cache it keeps, for each slot of a column, the last word that it has read. A pixel in that
// word needs no access. All words are forgotten where a strip begins.
class PixelReader : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<PixelReader> port{"port"};  // link to the banks
  StreamOut<MaskedPixel> pixels_out{"pixels_out"};               // to the filter of its side

 private:
  void store_entry(const TableEntry& entry);
  void take(const Slot& slot);

 public:
  // From the LUT reader with a table, from the sequencer without one.
  StreamIn<TableEntry, PixelReader, &PixelReader::store_entry> entries_in{"entries_in", this};
  StreamIn<Slot, PixelReader, &PixelReader::take> slots_in{"slots_in", this};

  // `lane`: its number on its side.
  PixelReader(const sc_core::sc_module_name& name, const CoreConfig& config, int lane);

  void start_frame(const Placement& image);  // `image`: where the frame's picture lies
  // Whether the entry that arrived last needs an access for its pixel.
  bool needs_access() const { return needs_access_; }
  // The oldest waiting entry; without meaning if none waits.
  std::uint32_t next_entry() const { return entries_[pixels_stored_ % kRing].entry; }
  // Reads or passes it, in the cycle that is `at` from now.
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
  // The number of refused accesses. Their pixels are 0.
  std::uint64_t errors() const { return errors_; }

 private:
  static constexpr std::size_t kRing = kLaneFifoRule.max;
  static constexpr std::uint64_t kNoWord = UINT64_MAX;

  struct Waiting {
    std::uint32_t entry = 0;
    bool needs_access = false;
  };

  // Whether the slot that comes next needs an access for this pixel of the image. To be called once for each
  // slot, in their order.
  bool next_needs_access(bool is_valid, int column, int row);
  // Handles the next slot: stores its pixel, which is read now if `needs_access`.
  void deliver(int column, int row, bool needs_access, const sc_core::sc_time& at);
  void pass() { pixels_[pixels_stored_++ % kRing] = MaskedPixel{}; }

  std::uint64_t width_;
  std::size_t slots_per_column_;
  bool has_cache_;
  Placement image_;
  memory::WordAccess access_{port};
  std::array<Waiting, kRing> entries_{};
  std::array<MaskedPixel, kRing> pixels_{};
  bool needs_access_ = false;
  // [slot of a column]: the word that is in the cache when the next slot is handled, or kNoWord. Words are
  // counted over the image.
  std::vector<std::uint64_t> cached_;
  std::vector<std::uint32_t> words_;  // [slot of a column]: the last word read
  // Numbers of slots since the start of the frame.
  std::size_t slots_arrived_ = 0;
  std::size_t pixels_stored_ = 0;
  std::size_t pixels_released_ = 0;
  std::uint64_t errors_ = 0;
};

}  // namespace stereotlm::fpga
