#pragma once

#include <cstdint>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/placement.h"
#include "models/memory/arbitration.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/collect.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

constexpr std::uint64_t kStallTimeoutCycles = std::uint64_t{1} << 26U;

// What some frames of the core have done. Boards that differ only in what the core does not notice share it.
struct CoreCounts {
  FrameAccesses accesses;
  std::vector<std::uint64_t> frame_cycles;
  BoardCounters counters;
};

// The figures of a board that has done this.
Statistics statistics_of(const BoardConfig& board, const CoreCounts& counts);

// The timing of PreloadedSystem (`--source preloaded`) without pixels, modules and the SystemC kernel: a loop
// over the core's control and the arbiters. The figures equal those of PreloadedSystem at Fidelity::kTiming.
// A process can run any number of them.
class CoreLoop {
 public:
  // `board` and `tables` outlive the loop. Throws std::invalid_argument if the tables do not fit the board.
  CoreLoop(const BoardConfig& board, const Tables& tables,
           std::uint64_t stall_timeout_cycles = kStallTimeoutCycles);
  CoreLoop(const CoreLoop&) = delete;
  CoreLoop& operator=(const CoreLoop&) = delete;

  // Runs the next frame. Throws std::runtime_error if for stall_timeout_cycles the matcher works in no cycle
  // and no result is written, because the frame would never end.
  void run_frame();

  // The frames, to record them.
  fpga::FrameRun& frames() { return frames_; }
  const fpga::FrameRun& frames() const { return frames_; }
  // Of the frames so far, one at least.
  CoreCounts counts() const;

 private:
  const BoardConfig& board_;
  fpga::AccessPatterns patterns_;
  fpga::BufferBases buffers_;
  std::uint64_t stall_timeout_cycles_;
  memory::Arbitration arbitration_;
  fpga::FrameRun frames_;
};

// What CoreLoop counts. Throws what it throws, and std::invalid_argument if `frames` is 0.
CoreCounts count_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                      std::uint64_t stall_timeout_cycles = kStallTimeoutCycles);
// The figures of count_core().
Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles = kStallTimeoutCycles);
// The lengths of the frames of run_core() alone, of tables with these access_patterns().
std::vector<std::uint64_t> core_frame_cycles(const BoardConfig& board, const fpga::AccessPatterns& patterns,
                                             std::uint64_t frames);
// The same if each request of a port were granted in its cycle.
std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board,
                                                 const fpga::AccessPatterns& patterns, std::uint64_t frames);
// The same. Throws std::invalid_argument if the tables do not fit the board.
std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board, const Tables& tables,
                                                 std::uint64_t frames);

}  // namespace stereotlm::platform
