#include "platform/config/buffer_layout.h"

#include <algorithm>
#include <map>

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

}  // namespace

std::string PlacedBuffer::label() const {
  const std::string name = name_of(buffer);
  return index < 0 ? name : name + '[' + std::to_string(index) + ']';
}

std::vector<PlacedBuffer> buffers(const BoardConfig& board) {
  std::vector<PlacedBuffer> all;
  for (std::size_t place = 0; place < kBufferKeys.size(); ++place) {
    const auto buffer = static_cast<Buffer>(place);
    if (board.fpga.joint_tables && buffer == Buffer::kRightLut) continue;
    visit_buffer(board.allocation, buffer, [&](const auto& banks) { add(all, buffer, banks); });
  }
  std::map<std::string, std::uint64_t> used;  // [bank]: words
  for (PlacedBuffer& buffer : all) {
    const auto bank = std::find_if(board.banks.begin(), board.banks.end(),
                                   [&](const BankConfig& one) { return one.name == buffer.bank; });
    const std::uint64_t words = buffer_words(buffer, board.image);
    const std::uint64_t first = fpga::registers::base_address(
        fpga::registers::base(static_cast<std::uint32_t>(bank - board.banks.begin()),
                              static_cast<std::uint32_t>(used[buffer.bank])));
    buffer.range = {first, first + 4 * words};
    used[buffer.bank] += words;
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

std::vector<AddressRange> buffer_ranges(const BoardConfig& board) {
  std::vector<AddressRange> ranges;
  for (const PlacedBuffer& buffer : buffers(board)) ranges.push_back(buffer.range);
  return ranges;
}

fpga::BufferBases buffer_bases(const BoardConfig& board) {
  fpga::BufferBases bases;
  bases.has_joint_tables = board.fpga.joint_tables;
  for (const PlacedBuffer& placed : buffers(board)) {
    const auto base = static_cast<std::uint32_t>(placed.range.first / 4);
    switch (placed.buffer) {
      case Buffer::kLeftImage:
        bases.left_images.push_back(base);
        break;
      case Buffer::kRightImage:
        bases.right_images.push_back(base);
        break;
      case Buffer::kDisparity:
        bases.disparities.push_back(base);
        break;
      case Buffer::kLeftLut:
        bases.left_lut = base;
        break;
      case Buffer::kRightLut:
        bases.right_lut = base;
        break;
    }
  }
  return bases;
}

}  // namespace stereotlm::platform
