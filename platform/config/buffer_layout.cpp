#include "platform/config/buffer_layout.h"

#include <algorithm>

#include "models/fpga/register_map.h"

namespace stereotlm::platform {
namespace {

void add(std::vector<PlacedBuffer>& all, Buffer buffer, int index, const BufferBanks& in) {
  const auto parts = static_cast<int>(in.banks.size());
  for (int part = 0; part < parts; ++part)
    all.push_back({buffer, index, in.banks[static_cast<std::size_t>(part)], part, parts});
}
void add(std::vector<PlacedBuffer>& all, Buffer buffer, const std::vector<BufferBanks>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) add(all, buffer, static_cast<int>(i), list[i]);
}
void add(std::vector<PlacedBuffer>& all, Buffer buffer, const std::optional<BufferBanks>& in) {
  if (in) add(all, buffer, -1, *in);
}

BufferBanks& banks_at(std::vector<BufferBanks>& list, int index) {
  return list[static_cast<std::size_t>(index)];
}
BufferBanks& banks_at(std::optional<BufferBanks>& in, int /*index*/) { return *in; }

}  // namespace

std::string PlacedBuffer::label() const {
  std::string label = name_of(buffer);
  if (index >= 0) label += '[' + std::to_string(index) + ']';
  if (parts > 1) label += ".rows[" + std::to_string(part) + ']';
  return label;
}

std::vector<PlacedBuffer> buffers(const BoardConfig& board) {
  std::vector<PlacedBuffer> all;
  for (std::size_t place = 0; place < kBufferKeys.size(); ++place) {
    const auto buffer = static_cast<Buffer>(place);
    if (board.fpga.joint_tables && buffer == Buffer::kRightLut) continue;
    visit_buffer(board.allocation, buffer, [&](const auto& banks) { add(all, buffer, banks); });
  }
  std::vector<std::uint64_t> used(board.banks.size() + 1);  // [bank]: words; the last: an unknown bank
  for (PlacedBuffer& buffer : all) {
    const auto found = std::find_if(board.banks.begin(), board.banks.end(),
                                    [&](const BankConfig& one) { return one.name == buffer.bank; });
    const auto bank = static_cast<std::size_t>(found - board.banks.begin());
    const std::uint64_t words = buffer_words(buffer, board.image);
    const std::uint64_t first = fpga::registers::base_address(
        fpga::registers::base(static_cast<std::uint32_t>(bank), static_cast<std::uint32_t>(used[bank])));
    buffer.range = {first, first + 4 * words};
    used[bank] += words;
  }
  return all;
}

void move_buffer(BoardConfig& board, const PlacedBuffer& buffer, const std::string& bank) {
  visit_buffer(board.allocation, buffer.buffer, [&](auto& all) {
    banks_at(all, buffer.index).banks[static_cast<std::size_t>(buffer.part)] = bank;
  });
  if (board.fpga.joint_tables) board.allocation.right_lut = board.allocation.left_lut;
}

std::uint64_t buffer_words(const PlacedBuffer& buffer, const ImageConfig& image) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(image.width) * buffer.rows(image);
  return buffer.index < 0 ? pixels : pixels / 4;
}

std::vector<bool> used_banks(const BoardConfig& board) {
  const std::vector<PlacedBuffer> all = buffers(board);
  std::vector<bool> used;
  for (const BankConfig& bank : board.banks) {
    used.push_back(std::any_of(all.begin(), all.end(), [&](const PlacedBuffer& buffer) {
      return buffer.bank == bank.name && buffer.rows(board.image) > 0;
    }));
  }
  return used;
}

std::vector<AddressRange> buffer_ranges(const BoardConfig& board) {
  std::vector<AddressRange> ranges;
  for (const PlacedBuffer& buffer : buffers(board)) ranges.push_back(buffer.range);
  return ranges;
}

std::vector<std::vector<std::uint32_t>> stripes_of(const BoardConfig& board) {
  std::vector<std::vector<std::uint32_t>> stripes;
  for (const PlacedBuffer& placed : buffers(board)) {
    if (placed.parts == 1) continue;
    if (placed.part == 0) stripes.emplace_back();
    stripes.back().push_back(static_cast<std::uint32_t>(placed.range.first / 4));
  }
  return stripes;
}

fpga::BufferBases buffer_bases(const BoardConfig& board) {
  fpga::BufferBases bases;
  bases.has_joint_tables = board.fpga.joint_tables;
  bases.stripes = stripes_of(board);
  for (const PlacedBuffer& placed : buffers(board)) {
    if (placed.part != 0) continue;
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
