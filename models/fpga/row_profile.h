#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// The end of a row of results, which is the write of its last word.
struct RowEnd {
  std::uint64_t cycles = 0;  // cycles of the frame up to that write, its own cycle included
  // [port]: in how many of these cycles the port was stalled. The host has no entry, because its words are
  // not counted cycle by cycle where they are uncontended.
  std::array<std::uint64_t, kCorePortCount> stalls{};

  friend bool operator==(const RowEnd& a, const RowEnd& b) {
    return a.cycles == b.cycles && a.stalls == b.stalls;
  }
  friend bool operator!=(const RowEnd& a, const RowEnd& b) { return !(a == b); }
};

// The ends of the rows of a frame, top row first. The cycles of the last row are the counted cycles of the
// frame.
using RowProfile = std::vector<RowEnd>;

}  // namespace stereotlm::fpga
