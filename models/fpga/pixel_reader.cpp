#include "models/fpga/pixel_reader.h"

#include <algorithm>

#include "models/fpga/core_ports.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

PixelReader::PixelReader(const sc_core::sc_module_name& name, const CoreConfig& config, int lane)
    : sc_module(name),
      width_(static_cast<std::uint64_t>(config.width)),
      slots_per_column_(static_cast<std::size_t>(FrameGeometry(config).slots_of_lane(lane))),
      has_cache_(config.pixel_cache == PixelCache::kWord),
      cached_(slots_per_column_),
      words_(slots_per_column_) {}

void PixelReader::start_frame(std::uint64_t image_address) {
  image_address_ = image_address;
  slots_arrived_ = 0;
  pixels_stored_ = 0;
  pixels_released_ = 0;
}

bool PixelReader::next_needs_access(bool is_valid, std::uint64_t pixel) {
  const std::size_t slot = slots_arrived_++;
  if (!has_cache_) return is_valid;
  if (slot % (slots_per_column_ * width_) == 0) std::fill(cached_.begin(), cached_.end(), kNoWord);
  if (!is_valid) return false;
  std::uint64_t& cached = cached_[slot % slots_per_column_];
  const std::uint64_t word = pixel / kernels::kPixelsPerWord;
  if (cached == word) return false;
  cached = word;
  return true;
}

void PixelReader::store_entry(const TableEntry& entry) {
  Waiting& waiting = entries_[slots_arrived_ % kRing];
  needs_access_ =
      next_needs_access(kernels::entry_is_valid(entry.entry),
                        pixel_of(kernels::entry_column(entry.entry), kernels::entry_row(entry.entry)));
  waiting = {entry.entry, needs_access_};
}

void PixelReader::handle(const sc_core::sc_time& at) {
  if (pixels_stored_ == slots_arrived_) {
    SC_REPORT_ERROR("/stereotlm/pixel_reader", "handle: no entry waits");
    return;
  }
  const Waiting& waiting = entries_[pixels_stored_ % kRing];
  if (!kernels::entry_is_valid(waiting.entry)) {
    pass();
    return;
  }
  deliver(pixel_of(kernels::entry_column(waiting.entry), kernels::entry_row(waiting.entry)),
          waiting.needs_access, at);
}

void PixelReader::take(const Slot& slot) {
  const std::uint64_t pixel = pixel_of(slot.column, slot.row);
  const bool needs_access = next_needs_access(!slot.empty, pixel);
  if (slot.empty) {
    pass();
    return;
  }
  deliver(pixel, needs_access, slot.at);
}

void PixelReader::deliver(std::uint64_t pixel, bool needs_access, const sc_core::sc_time& at) {
  std::uint32_t& word = words_[has_cache_ ? pixels_stored_ % slots_per_column_ : 0];
  if (needs_access) {
    sc_core::sc_time delay = at;
    if (!access_.read(image_address_ + pixel_word_offset(pixel), delay)) ++errors_;
    word = access_.word();
  }
  pixels_[pixels_stored_++ % kRing] = {kernels::pixel_of_word(word, pixel), true};
}

}  // namespace stereotlm::fpga
