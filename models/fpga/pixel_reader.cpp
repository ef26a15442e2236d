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

void PixelReader::start_frame(const Placement& image) {
  image_ = image;
  slots_arrived_ = 0;
  pixels_stored_ = 0;
  pixels_released_ = 0;
}

bool PixelReader::next_needs_access(bool is_valid, int column, int row) {
  const std::size_t slot = slots_arrived_++;
  if (!has_cache_) return is_valid;
  if (slot % (slots_per_column_ * width_) == 0) std::fill(cached_.begin(), cached_.end(), kNoWord);
  if (!is_valid) return false;
  std::uint64_t& cached = cached_[slot % slots_per_column_];
  const std::uint64_t word = (static_cast<std::uint64_t>(row) * width_ + static_cast<std::uint64_t>(column)) /
                             kernels::kPixelsPerWord;
  if (cached == word) return false;
  cached = word;
  return true;
}

void PixelReader::store_entry(const TableEntry& entry) {
  Waiting& waiting = entries_[slots_arrived_ % kRing];
  needs_access_ = next_needs_access(kernels::entry_is_valid(entry.entry), kernels::entry_column(entry.entry),
                                    kernels::entry_row(entry.entry));
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
  deliver(kernels::entry_column(waiting.entry), kernels::entry_row(waiting.entry), waiting.needs_access, at);
}

void PixelReader::take(const Slot& slot) {
  const bool needs_access = next_needs_access(!slot.empty, slot.column, slot.row);
  if (slot.empty) {
    pass();
    return;
  }
  deliver(slot.column, slot.row, needs_access, slot.at);
}

void PixelReader::deliver(int column, int row, bool needs_access, const sc_core::sc_time& at) {
  std::uint32_t& word = words_[has_cache_ ? pixels_stored_ % slots_per_column_ : 0];
  const auto place = static_cast<std::uint64_t>(column);
  if (needs_access) {
    sc_core::sc_time delay = at;
    if (!access_.read(image_.address(static_cast<std::uint64_t>(row), place / kernels::kPixelsPerWord),
                      delay))
      ++errors_;
    word = access_.word();
  }
  pixels_[pixels_stored_++ % kRing] = {kernels::pixel_of_word(word, place), true};
}

}  // namespace stereotlm::fpga
