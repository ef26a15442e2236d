#pragma once

#include <cstdint>

namespace stereotlm {

// A range of byte addresses, such as those of a buffer.
struct AddressRange {
  std::uint64_t first = 0;  // address of the first byte
  std::uint64_t end = 0;    // address of the first byte behind the range

  // Whether a byte is in the range, and whether there is one in both.
  bool contains(std::uint64_t address) const { return first <= address && address < end; }
  bool overlaps(const AddressRange& other) const { return first < other.end && other.first < end; }
};

}  // namespace stereotlm
