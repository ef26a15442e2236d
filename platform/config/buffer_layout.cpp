#include "platform/config/buffer_layout.h"

#include "models/fpga/register_map.h"
#include "platform/config/board_rules.h"

namespace stereotlm::platform {
namespace {

std::uint32_t word_of(const BufferPlace& place) {
  return fpga::registers::base(static_cast<std::uint32_t>(place.bank), place.first_word);
}

std::vector<std::uint32_t> words_of(const std::vector<BufferPlace>& places) {
  std::vector<std::uint32_t> words;
  for (const BufferPlace& place : places) words.push_back(word_of(place));
  return words;
}

std::optional<std::uint32_t> word_of(const std::optional<BufferPlace>& place) {
  return place ? std::optional(word_of(*place)) : std::nullopt;
}

}  // namespace

fpga::FrameBuffers frame_buffers(const BoardConfig& board) {
  const BufferLayout layout = layout_buffers(board);
  return {words_of(layout.left_image), words_of(layout.right_image), words_of(layout.disparity),
          word_of(layout.left_lut), word_of(layout.right_lut)};
}

std::vector<AddressRange> buffer_ranges(const BoardConfig& board) {
  const fpga::FrameBuffers words = frame_buffers(board);
  std::vector<std::uint32_t> first_words;
  for (const auto* list : {&words.left_images, &words.right_images, &words.disparities})
    first_words.insert(first_words.end(), list->begin(), list->end());
  for (const auto& table : {words.left_lut, words.right_lut}) {
    if (table) first_words.push_back(*table);
  }
  std::vector<AddressRange> ranges;
  for (const Buffer& buffer : buffers(board.allocation)) {
    const std::uint64_t first = fpga::registers::base_address(first_words[ranges.size()]);
    ranges.push_back({first, first + 4 * buffer_words(buffer, board.image)});
  }
  return ranges;
}

}  // namespace stereotlm::platform
