#include "platform/buffer_words.h"

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

BufferWords buffer_words(const BoardConfig& board) {
  const BufferLayout layout = layout_buffers(board);
  return {words_of(layout.left_image), words_of(layout.right_image), words_of(layout.disparity),
          word_of(layout.left_lut), word_of(layout.right_lut)};
}

}  // namespace stereotlm::platform
