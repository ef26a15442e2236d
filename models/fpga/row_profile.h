#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// A row of results is complete with the write of its last word.
struct RowEnd {
  std::uint64_t cycles = 0;  // of the frame, up to that write, its own cycle included
  // [port]: in how many of them the port was stalled. The words of the host are not counted cycle by cycle
  // where they are uncontended, so the host has no entry.
  std::array<std::uint64_t, kCorePortCount> stalls{};

  friend bool operator==(const RowEnd& a, const RowEnd& b) {
    return a.cycles == b.cycles && a.stalls == b.stalls;
  }
  friend bool operator!=(const RowEnd& a, const RowEnd& b) { return !(a == b); }
};

// The rows of a frame, the top one first. The cycles of the last row are the counted cycles of the frame.
using RowProfile = std::vector<RowEnd>;

}  // namespace stereotlm::fpga
