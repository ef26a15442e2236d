#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

// The core's own ports: those before the host's, whose words are not counted cycle by cycle where they meet
// nobody.
inline constexpr std::size_t kCorePortCount = memory::index_of(memory::Port::kHost);

// A row of results is whole with the write of its last word.
struct RowEnd {
  std::uint64_t cycles = 0;                            // of the frame, that write's included
  std::array<std::uint64_t, kCorePortCount> stalls{};  // of these, those that each port was refused in

  friend bool operator==(const RowEnd& a, const RowEnd& b) {
    return a.cycles == b.cycles && a.stalls == b.stalls;
  }
  friend bool operator!=(const RowEnd& a, const RowEnd& b) { return !(a == b); }
};

// Of a frame, one for each row, the top one first. The last one's cycles are the counted ones of the frame.
using RowProfile = std::vector<RowEnd>;

}  // namespace stereotlm::fpga
