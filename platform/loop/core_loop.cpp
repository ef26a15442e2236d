#include "platform/loop/core_loop.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

// Runs the next frame of the core without data.
void run_next_frame(fpga::FrameRun& core, const fpga::BufferBases& buffers,
                    const fpga::AccessPatterns& patterns, std::uint64_t stall_timeout_cycles) {
  const std::uint64_t frame = core.frame_cycles().size();
  core.start_direct(core.done_cycle(), buffers.of_frame(frame), patterns);
  while (!core.control().frame_done()) {
    core.run_ahead(core.cycle() + stall_timeout_cycles);
    if (core.stalled_cycles() == 0) continue;
    throw std::runtime_error(
        fmt::format("frame {} of the core: no slot consumed and no result written for {} cycles", frame,
                    stall_timeout_cycles));
  }
  core.finish();
  core.end();
}

const BoardConfig& checked(const BoardConfig& board, const Tables& tables) {
  check_tables(board, tables);
  return board;
}

memory::Arbitration arbitration_of(const BoardConfig& board) {
  return {arbiter_of_ports(board.fpga.arbiter, core_ports(board)), ssram_configs(board)};
}

std::vector<std::uint64_t> frame_cycles(const BoardConfig& board, const fpga::AccessPatterns& patterns,
                                        std::uint64_t frames, memory::Arbitration arbitration) {
  fpga::FrameRun core(core_config(board), ssram_configs(board), arbitration, kStallTimeoutCycles);
  const fpga::BufferBases buffers = buffer_bases(board);
  while (core.frame_cycles().size() < frames) run_next_frame(core, buffers, patterns, kStallTimeoutCycles);
  return core.frame_cycles();
}

}  // namespace

CoreLoop::CoreLoop(const BoardConfig& board, const Tables& tables, std::uint64_t stall_timeout_cycles)
    : board_(checked(board, tables)),
      patterns_(access_patterns(board, &tables)),
      buffers_(buffer_bases(board)),
      stall_timeout_cycles_(stall_timeout_cycles),
      arbitration_(arbitration_of(board)),
      frames_(core_config(board), ssram_configs(board), arbitration_, stall_timeout_cycles) {}

void CoreLoop::run_frame() { run_next_frame(frames_, buffers_, patterns_, stall_timeout_cycles_); }

CoreCounts CoreLoop::counts() const {
  return {frame_accesses(board_, patterns_), frames_.frame_cycles(), counters_of(frames_, arbitration_)};
}

Statistics statistics_of(const BoardConfig& board, const CoreCounts& counts) {
  return collect_statistics(board, counts.accesses, "fast", counts.frame_cycles, counts.counters);
}

CoreCounts count_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                      std::uint64_t stall_timeout_cycles) {
  if (frames == 0) throw std::invalid_argument("frames = 0: must be 1 or more");
  CoreLoop core(board, tables, stall_timeout_cycles);
  for (std::uint64_t frame = 0; frame < frames; ++frame) core.run_frame();
  return core.counts();
}

Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles) {
  return statistics_of(board, count_core(board, tables, frames, stall_timeout_cycles));
}

std::vector<std::uint64_t> core_frame_cycles(const BoardConfig& board, const fpga::AccessPatterns& patterns,
                                             std::uint64_t frames) {
  return frame_cycles(board, patterns, frames, arbitration_of(board));
}

std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board,
                                                 const fpga::AccessPatterns& patterns, std::uint64_t frames) {
  memory::Arbitration arbitration = arbitration_of(board);
  arbitration.grant_all_requests();
  return frame_cycles(board, patterns, frames, std::move(arbitration));
}

std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board, const Tables& tables,
                                                 std::uint64_t frames) {
  check_tables(board, tables);
  return waitless_frame_cycles(board, access_patterns(board, &tables), frames);
}

}  // namespace stereotlm::platform
