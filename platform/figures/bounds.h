#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_ports.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// Numbers of reads that the ports make in a frame. They depend on the geometry of the frame and on the
// tables, not on the allocation of the buffers.
struct FrameAccesses {
  std::vector<std::uint64_t> reads;  // [port]
  // Of boards with stripes or sdram: [port][row of the buffer]: reads of that row.
  std::vector<std::vector<std::uint64_t>> reads_of_row;
  // Of boards with sdram: [port group][row of the buffer][word of the row]: whether it is accessed. Empty if
  // each word is.
  std::array<std::vector<std::vector<bool>>, fpga::kCoreGroupCount> touched;
  // [side][row]: pixel reads of the slots of one rectified row. Empty if each pixel is its own source.
  std::array<std::vector<std::uint64_t>, 2> pixels_of_row;
};

// Which slots of a frame access their pixels. `tables`: null for the identity; else they fit the board, and
// outlive the result.
fpga::AccessPatterns access_patterns(const BoardConfig& board, const Tables* tables);

FrameAccesses frame_accesses(const BoardConfig& board, const fpga::AccessPatterns& patterns);  // of one frame
inline FrameAccesses frame_accesses(const BoardConfig& board, const Tables& tables) {
  return frame_accesses(board, access_patterns(board, &tables));
}

// The same for identity tables, which it does not read: it takes some microseconds.
FrameAccesses identity_accesses(const BoardConfig& board);

// The reads and writes that the core makes in each bank in frames 0..frames-1. `with_host`: and those of the
// host, which writes the pictures and reads the results. The other members are 0.
std::vector<BankStatistics> accesses_of_banks(const BoardConfig& board, const FrameAccesses& accesses,
                                              std::uint64_t frames, bool with_host = false);

// A lower bound for the length of a frame: the cycles that one resource of the core needs for it, pipeline
// latency included.
//
// | resource | needs                                                                                      |
// |----------|--------------------------------------------------------------------------------------------|
// | port P   | A LUT or pixel port: one cycle per slot of its lane. The result port: one cycle per word.  |
// |          | The first port of a lane (LUT; pixel if the side has no table) also waits for a place in   |
// |          | the lane, which holds F slots (fpga.lane_fifo_slots). Slot s+F is taken only after slot s  |
// |          | is consumed. From its take to its consumption a slot needs at least the read latencies of  |
// |          | the lane and the folds of the matcher.                                                     |
// | bank B   | max(reads, writes) cycles with separate ports, else reads + writes; turnaround is not      |
// |          | counted. After the last read: the latencies of its slot up to the matcher, the folds on    |
// |          | it, the drain and the last writes. Of sdram also the openings of rows and the refreshes    |
// |          | that cannot be avoided: with A accesses to Z rows the least X >= A + activate_cycles *     |
// |          | max(0, Z - internal_banks) + refresh_cycles * max(0, floor(X / interval) - 1).             |
// | matcher  | The read latencies of the first slot, the folds on each slot, the drain, the last writes.  |
//
// The last writes store the words that the last column completes, one for each row of the last strip.
struct ResourceBound {
  std::string resource;      // "port left_lut", "bank bank0", "matcher"
  std::uint64_t cycles = 0;  // of a frame, at least
};

// The resource of a bank, and the bank of a resource; nullopt if the resource is no bank.
inline constexpr const char* kBankResource = "bank ";
inline std::string resource_of_bank(const std::string& bank) { return kBankResource + bank; }
inline std::optional<std::string> bank_of_resource(const std::string& resource) {
  const std::string prefix = kBankResource;
  if (resource.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return resource.substr(prefix.size());
}

// The bounds of frame number `frame` with these accesses: first the ports, then the banks that the frame
// uses, last the matcher.
std::vector<ResourceBound> frame_bounds(const BoardConfig& board, const FrameAccesses& accesses,
                                        std::uint64_t frame);

// For each frame of one turn of the allocation's lists, the resource of frame_bounds() that needs the most
// cycles. If several need as many, it is the last of them in the order of frame_bounds().
std::vector<ResourceBound> turn_bounds(const BoardConfig& board, const FrameAccesses& accesses);

// The upper bound for the frame rate of the core over whole turns of the allocation's lists, or over frames
// 0..frames-1; and the resource that limits the slowest of these frames.
Bound core_bound(const BoardConfig& board, const FrameAccesses& accesses,
                 std::optional<std::uint64_t> frames = std::nullopt);
inline Bound core_bound(const BoardConfig& board, const Tables& tables) {
  return core_bound(board, frame_accesses(board, tables));
}

// An upper bound for the frame rate that one part of the computer allows to all masters that use it.
//
// | resource | limit                                                                                      |
// |----------|--------------------------------------------------------------------------------------------|
// | camera   | Its frame clock. On demand: the time from the first to the last pixel of a frame.          |
// | pci      | The clocks of the words of a pair and a result, and of the fewest bursts that hold them.   |
// |          | Plus the bursts that pci.load gets at least, if its first request is at time 0.            |
// | bridge   | The time of the words of a pair and a result on the local bus, with the waits for the      |
// |          | edges of its clock and of the FPGA's: local_bus_cycles_a_word().                           |
// | bank B   | reads + writes, with separate ports max(reads, writes): of the core, of the pictures that  |
// |          | are written, of the results that are read back. One cycle each.                            |
//
// With `whole_pictures` false, the words that the capture boards write are not counted: a run that drops
// pixels moves fewer.
struct RateBound {
  std::string resource;          // "camera", "pci", "bridge", "bank bank0"
  double frames_per_second = 0;  // at most
};

// The fewest cycles of the FPGA that a word takes on the local bus, on average over bursts of at most
// bridge.dma_burst_words words and the clocks between them, if the local bus has this clock.
double local_bus_cycles_a_word(const BoardConfig& board, double local_clock_mhz);

// The clock of the FPGA, or its divisor next to the clock of the local bus, MHz.
inline double clock_in_step(const BoardConfig& board) {
  return board.fpga.clock_mhz /
         std::max(1.0, std::round(board.fpga.clock_mhz / board.bridge.local_clock_mhz));
}

// A line on a local bus that would be at least 5 % faster with clock_in_step(); empty for any other.
std::string local_bus_remark(const BoardConfig& board);

// The bounds of the computer, in the order of the table at RateBound: over whole turns of the allocation's
// lists, or over frames 0..frames-1.
std::vector<RateBound> computer_bounds(const BoardConfig& board, const FrameAccesses& accesses,
                                       bool whole_pictures,
                                       std::optional<std::uint64_t> frames = std::nullopt);

// Sets bound.system to the least of bound.core and the bounds of computer_bounds(), and
// bound.system_limited_by to its resource. `frames`: as for core_bound() and computer_bounds().
void add_system_bound(const BoardConfig& board, const FrameAccesses& accesses, bool whole_pictures,
                      Bound& bound, std::optional<std::uint64_t> frames = std::nullopt);

// An upper bound for the steady rate of a whole computer that loses no pixels: bound.system of core_bound()
// and add_system_bound(), or a smaller one of how frames, captures, copies and read-backs take turns. For
// searches, as the bounds of search_bounds.h: proofs are in sw/explore/BOUNDS.md.
double steady_bound(const BoardConfig& board, const FrameAccesses& accesses);

}  // namespace stereotlm::platform
