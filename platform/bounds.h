#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// How often each side's ports access memory in a frame: what bounds need of the tables, the same for every
// allocation of a board's buffers.
struct PortAccesses {
  std::uint64_t lut = 0;
  std::uint64_t pixel = 0;
};
struct FrameAccesses {
  PortAccesses left;
  PortAccesses right;
};

// Throws std::invalid_argument if the board has problems.
FrameAccesses frame_accesses(const BoardConfig& board, const Tables& tables);

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

// What a part of the computer around the board limits the rate of frames to, counted from time 0 to the last
// delivery; no run can be faster:
//   camera      its frame clock; on demand the time from the first to the last pixel of a frame
//   pci         the clocks of the words of a pair and a result and of the bursts that they need at least
//   bridge      the same for its local bus, whose words are granted one a cycle of the FPGA at most
// A run that drops pixels moves fewer words: without `whole_pictures` those that captures write are left out.
struct RateBound {
  std::string resource;  // "camera", "pci", "bridge"
  double frames_per_second = 0;
};

// In this order. Throws std::invalid_argument if the board has problems.
std::vector<RateBound> computer_bounds(const BoardConfig& board, bool whole_pictures);

// Puts the least of bound.core and computer_bounds() into bound.system. Throws as they do.
void add_system_bound(const BoardConfig& board, bool whole_pictures, Bound& bound);

// How a run of a computer goes on: the core starts with frame number `frame` at `start_s`, in seconds from
// time 0.
struct FrameBegin {
  std::uint64_t frame = 0;
  double start_s = 0;
};

// The earliest end of the last of `frames` deliveries, in seconds from time 0, of a run that goes on like
// this and loses no pixel: the core does its frames one after another, none faster than its bound; and each
// bank has one access a cycle for what the core reads and writes, for the results that are read back, and for
// the pairs that can only come once the core has begun with a frame before (all but the first of each
// buffer). Throws std::invalid_argument if the board has problems.
double least_delivery_s(const BoardConfig& board, const FrameAccesses& accesses, std::uint64_t frames,
                        const FrameBegin& from);

// Frames per second that frames 0..frames-1 cannot exceed, and the resource that limits the slowest of them
// (of equal ones the last in the order above). Throws std::invalid_argument if the board has problems, or
// there are no frames.
Bound core_bound(const BoardConfig& board, const FrameAccesses& accesses, std::uint64_t frames);
Bound core_bound(const BoardConfig& board, const Tables& tables, std::uint64_t frames);

}  // namespace stereotlm::platform
