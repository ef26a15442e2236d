#include "models/fpga/pixel_reader.h"

#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"
#include "models/memory/direct_memory.h"

namespace stereotlm::fpga {

PixelReader::PixelReader(const sc_core::sc_module_name& name, int width)
    : sc_module(name), width_(static_cast<std::uint64_t>(width)) {}

void PixelReader::start_frame(std::uint64_t image_address) {
  image_address_ = image_address;
  entries_stored_ = 0;
  entries_handled_ = 0;
  pixels_stored_ = 0;
  pixels_released_ = 0;
}

void PixelReader::store_entry(const TableEntry& entry) { entries_[entries_stored_++ % kRing] = entry; }

void PixelReader::handle(const sc_core::sc_time& at) {
  if (entries_handled_ == entries_stored_) {
    SC_REPORT_ERROR("/stereotlm/pixel_reader", "handle: no entry waits");
    return;
  }
  const std::uint32_t entry = entries_[entries_handled_++ % kRing].entry;
  if (!kernels::entry_is_valid(entry)) {
    pass();
    return;
  }
  read(static_cast<std::uint64_t>(kernels::entry_column(entry)),
       static_cast<std::uint64_t>(kernels::entry_row(entry)), at);
}

void PixelReader::take(const Slot& slot) {
  if (slot.empty) {
    pass();
    return;
  }
  read(static_cast<std::uint64_t>(slot.column), static_cast<std::uint64_t>(slot.row), slot.at);
}

void PixelReader::read(std::uint64_t column, std::uint64_t row, const sc_core::sc_time& at) {
  const std::uint64_t pixel = row * width_ + column;
  sc_core::sc_time delay = at;
  if (!access_.read(image_address_ + pixel / kernels::kPixelsPerWord * 4, delay)) ++stats_.errors;
  ++stats_.reads;
  pixels_[pixels_stored_++ % kRing] = {kernels::pixel_of_word(access_.word(), pixel), true};
}

void PixelReader::pass() {
  ++stats_.passed_slots;
  pixels_[pixels_stored_++ % kRing] = MaskedPixel{};
}

const std::uint8_t* PixelReader::image(int height) {
  return memory::direct_memory(port, tlm::TLM_READ_COMMAND, image_address_,
                               width_ * static_cast<std::uint64_t>(height));
}

void PixelReader::count(const Stats& frame) {
  stats_.reads += frame.reads;
  stats_.passed_slots += frame.passed_slots;
}

}  // namespace stereotlm::fpga
