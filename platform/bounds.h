#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/board_config.h"
#include "platform/statistics.h"
#include "platform/tables.h"

namespace stereotlm::platform {

// The fewest cycles that one resource of the core needs for a frame, pipeline latency included. No run can be
// faster:
//   port P      one slot or word a cycle. For the port that takes the slots of a side (of its table, or if it
//               has none of its images) also: with F places in the lane, slot s+F is not taken before slot s
//               has left it, latencies later
//   bank B      one access a cycle, turnaround left out; after the last read the drain and the last write
//   matcher     the latencies of the first slot, one slot a cycle, the drain, the last write
struct ResourceBound {
  std::string resource;  // "port left_lut", "bank bank0", "matcher"
  std::uint64_t cycles = 0;
};

// For frame number `frame` with these tables, in the order: ports, banks of the frame, matcher. Throws
// std::invalid_argument if the board has problems.
std::vector<ResourceBound> frame_bounds(const BoardConfig& board, const Tables& tables, std::uint64_t frame);

// The number of frames after which the allocation lists begin anew together: the least common multiple of
// their lengths. Throws std::invalid_argument if the board has problems.
std::uint64_t allocation_period_frames(const BoardConfig& board);

// Frames per second that frames 0..frames-1 cannot exceed, and the resource that limits the slowest of them
// (of equal ones the last in the order above). Throws std::invalid_argument if the board has problems, or
// there are no frames.
Bound core_bound(const BoardConfig& board, const Tables& tables, std::uint64_t frames);

}  // namespace stereotlm::platform
