#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/address_range.h"
#include "models/fpga/core_ports.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The members of an allocation: lists of buffers that the frames use in turn, and tables of one buffer each.
// Buffers that share a bank lie in it in this order (contract 1.5).
enum class Buffer { kLeftImage, kRightImage, kDisparity, kLeftLut, kRightLut };

// Their keys in a board file.
inline constexpr std::array<const char*, 5> kBufferKeys = {"allocation.left_image", "allocation.right_image",
                                                           "allocation.disparity", "allocation.left_lut",
                                                           "allocation.right_lut"};

// "allocation.left_image"
constexpr const char* key_of(Buffer buffer) { return kBufferKeys[static_cast<std::size_t>(buffer)]; }

// "left_image"
constexpr const char* name_of(Buffer buffer) {
  return key_of(buffer) + std::string_view("allocation.").size();
}

// Calls `visit` with the member `buffer` of `all`, which is an AllocationConfig. The member is a std::vector
// for a list, and a std::optional for a table. Returns the result of `visit`.
template <typename All, typename Visit>
decltype(auto) visit_buffer(All& all, Buffer buffer, const Visit& visit) {
  switch (buffer) {
    case Buffer::kLeftImage:
      return visit(all.left_image);
    case Buffer::kRightImage:
      return visit(all.right_image);
    case Buffer::kDisparity:
      return visit(all.disparity);
    case Buffer::kLeftLut:
      return visit(all.left_lut);
    case Buffer::kRightLut:
      break;
  }
  return visit(all.right_lut);
}

// One buffer, and the bank that holds it; or a part of a striped buffer.
struct PlacedBuffer {
  Buffer buffer;     // of which list, or which table
  int index;         // index in its list; -1: a table
  std::string bank;  // name
  int part = 0;      // row y of the buffer is in part y mod `parts`
  int parts = 1;     // 1: in one bank
  // Its addresses on the local bus. Buffers that share a bank begin at word 0, and follow each other in the
  // order of buffers() (contract 1.5). Without meaning if the board has no such bank.
  AddressRange range = {};

  // "left_image[0]", "left_lut"; of a part "left_lut.rows[2]"
  std::string label() const;
  std::string path() const { return "allocation." + label(); }  // "allocation.left_image[0]"
  std::uint64_t rows(const ImageConfig& image) const {
    return static_cast<std::uint64_t>((image.height - part + parts - 1) / parts);
  }
};

// All buffers, in the order of Buffer; the buffers of a list are in the order of the list, and the parts of a
// striped one in their order. Joint tables are one buffer, kLeftLut.
std::vector<PlacedBuffer> buffers(const BoardConfig& board);

// Puts a buffer of the board, or a part of one, into another bank.
void move_buffer(BoardConfig& board, const PlacedBuffer& buffer, const std::string& bank);

// Size of a buffer, or of a part, in 32-bit words.
std::uint64_t buffer_words(const PlacedBuffer& buffer, const ImageConfig& image);

// [bank]: whether it holds a word of a buffer.
std::vector<bool> used_banks(const BoardConfig& board);

// PlacedBuffer::range of each buffer, in the order of buffers().
std::vector<AddressRange> buffer_ranges(const BoardConfig& board);

// CoreConfig::stripes.
std::vector<std::vector<std::uint32_t>> stripes_of(const BoardConfig& board);

// The values of the base registers for these buffers.
fpga::BufferBases buffer_bases(const BoardConfig& board);

}  // namespace stereotlm::platform
