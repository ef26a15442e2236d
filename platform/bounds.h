#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// Memory accesses of one side's ports in a frame. They follow from the tables and are the same for every
// allocation of the buffers.
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

// A lower bound for the length of a frame: the cycles that one resource of the core needs, pipeline latency
// included. No run is faster.
//
// | resource | needs                                                                                      |
// |----------|--------------------------------------------------------------------------------------------|
// | port P   | One cycle per slot or word. The first port of a lane (its LUT port, or its pixel port if   |
// |          | the side has no table) also waits for the lane: with F places, slot s+F is taken when slot |
// |          | s has left, the read latencies later.                                                      |
// | bank B   | One cycle per access, without turnaround. After the last read the drain and the last write.|
// | matcher  | The latencies of the first slot, one cycle per slot, the drain, the last write.            |
struct ResourceBound {
  std::string resource;  // "port left_lut", "bank bank0", "matcher"
  std::uint64_t cycles = 0;
};

// The bounds of frame number `frame` with these tables: ports, banks of the frame, matcher. Throws
// std::invalid_argument if the board has problems.
std::vector<ResourceBound> frame_bounds(const BoardConfig& board, const Tables& tables, std::uint64_t frame);

// An upper bound for the frame rate, from time 0 to the last delivery, that one part of the computer around
// the board allows. No run is faster.
//
// | resource | limit                                                                                      |
// |----------|--------------------------------------------------------------------------------------------|
// | camera   | Its frame clock. On demand: the time from the first to the last pixel of a frame.          |
// | pci      | The clocks for the words of a pair and a result, and for the fewest bursts that hold them. |
// | bridge   | The same for its local bus, which moves at most one word per cycle of the FPGA.            |
//
// A run that drops pixels moves fewer words. Without `whole_pictures` the words of captures do not count.
struct RateBound {
  std::string resource;  // "camera", "pci", "bridge"
  double frames_per_second = 0;
};

// The bounds in the order of the table. Throws std::invalid_argument if the board has problems.
std::vector<RateBound> computer_bounds(const BoardConfig& board, bool whole_pictures);

// Sets bound.system to the least of bound.core and computer_bounds(). Throws as computer_bounds() does.
void add_system_bound(const BoardConfig& board, bool whole_pictures, Bound& bound);

// A point in the run of a computer: the core starts frame number `frame` at `start_s`, in seconds from time
// 0.
struct FrameBegin {
  std::uint64_t frame = 0;
  double start_s = 0;
};

// A lower bound for the time of the last of `frames` deliveries, in seconds from time 0, of a run that
// continues from `from` and loses no pixel. Two things limit the run:
// - The core runs its frames one after another, none faster than its bound.
// - A bank has one access per cycle. It serves what the core reads and writes, the results that are read
//   back, and each pair that is captured after the core has begun an earlier frame (all but the first pair of
//   each buffer).
// Throws std::invalid_argument if the board has problems.
double least_delivery_s(const BoardConfig& board, const FrameAccesses& accesses, std::uint64_t frames,
                        const FrameBegin& from);

// The upper bound for the frame rate of frames 0..frames-1, and the resource that limits the slowest of them
// (of equal ones the last in the order of frame_bounds()). Throws std::invalid_argument if the board has
// problems or `frames` is 0.
Bound core_bound(const BoardConfig& board, const FrameAccesses& accesses, std::uint64_t frames);
Bound core_bound(const BoardConfig& board, const Tables& tables, std::uint64_t frames);

}  // namespace stereotlm::platform
