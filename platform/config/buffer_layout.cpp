#include "platform/config/buffer_layout.h"

#include "models/fpga/register_map.h"

namespace stereotlm::platform {
namespace {

void add(std::vector<PlacedBuffer>& all, Buffer buffer, const std::vector<std::string>& banks) {
  for (std::size_t i = 0; i < banks.size(); ++i) all.push_back({buffer, static_cast<int>(i), banks[i]});
}
void add(std::vector<PlacedBuffer>& all, Buffer buffer, const std::optional<std::string>& bank) {
  if (bank) all.push_back({buffer, -1, *bank});
}

std::string& bank_at(std::vector<std::string>& banks, int index) {
  return banks[static_cast<std::size_t>(index)];
}
std::string& bank_at(std::optional<std::string>& bank, int /*index*/) { return *bank; }

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

std::optional<Buffer> buffer_of_key(std::string_view key) {
  for (const BufferKey& known : kBufferKeys) {
    if (known.key == key) return known.buffer;
  }
  return std::nullopt;
}

std::string PlacedBuffer::label() const {
  const std::string name = name_of(buffer);
  return index < 0 ? name : name + '[' + std::to_string(index) + ']';
}

std::vector<PlacedBuffer> buffers(const BoardConfig& board) {
  std::vector<PlacedBuffer> all;
  for (const BufferKey& known : kBufferKeys) {
    if (board.fpga.joint_tables && known.buffer == Buffer::kRightLut) continue;
    visit_buffer(board.allocation, known.buffer, [&](const auto& banks) { add(all, known.buffer, banks); });
  }
  return all;
}

void move_buffer(BoardConfig& board, const PlacedBuffer& buffer, const std::string& bank) {
  visit_buffer(board.allocation, buffer.buffer, [&](auto& banks) { bank_at(banks, buffer.index) = bank; });
  if (board.fpga.joint_tables) board.allocation.right_lut = board.allocation.left_lut;
}

std::uint64_t buffer_words(const PlacedBuffer& buffer, const ImageConfig& image) {
  const auto pixels = static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
  return buffer.index < 0 ? pixels : pixels / 4;
}

fpga::BufferBases buffer_bases(const BoardConfig& board) {
  const BufferLayout layout = layout_buffers(board);
  return {words_of(layout.left_image), words_of(layout.right_image), words_of(layout.disparity),
          word_of(layout.left_lut),    word_of(layout.right_lut),    board.fpga.joint_tables};
}

std::vector<AddressRange> buffer_ranges(const BoardConfig& board) {
  const fpga::BufferBases words = buffer_bases(board);
  std::vector<std::uint32_t> first_words;
  for (const auto* list : {&words.left_images, &words.right_images, &words.disparities})
    first_words.insert(first_words.end(), list->begin(), list->end());
  for (const auto& table : {words.left_lut, words.right_lut}) {
    if (table) first_words.push_back(*table);
  }
  std::vector<AddressRange> ranges;
  for (const PlacedBuffer& buffer : buffers(board)) {
    const std::uint64_t first = fpga::registers::base_address(first_words[ranges.size()]);
    ranges.push_back({first, first + 4 * buffer_words(buffer, board.image)});
  }
  return ranges;
}

}  // namespace stereotlm::platform
