#include "platform/assembly/preloaded_system.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/frame_run.h"
#include "models/memory/arbitration.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/collect.h"

namespace stereotlm::platform {
namespace {

using kernels::RectificationTable;

const RectificationTable* pointer_to(const std::optional<RectificationTable>& table) {
  return table ? &*table : nullptr;
}

const BoardConfig& checked(const BoardConfig& board, const Tables& tables) {
  check_tables(board, tables);
  return board;
}

constexpr std::uint64_t kFrameTimeoutCycles = std::uint64_t{1} << 26U;

// Runs frames of the core without data.
void run_frames(fpga::FrameRun& core, const BoardConfig& board, const fpga::AccessPatterns& patterns,
                std::uint64_t frames, std::uint64_t stall_timeout_cycles, const KeepGoing& keep_going = {}) {
  const fpga::BufferBases buffers = buffer_bases(board);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
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
    if (keep_going && !keep_going(frame + 1, core.cycle())) return;
  }
}

memory::Arbitration arbitration_of(const BoardConfig& board) {
  return {arbiter_of_ports(board.fpga.arbiter, core_ports(board)), ssram_configs(board)};
}

std::vector<std::uint64_t> frame_cycles(const BoardConfig& board, const fpga::AccessPatterns& patterns,
                                        std::uint64_t frames, memory::Arbitration arbitration) {
  fpga::FrameRun core(core_config(board), ssram_configs(board), arbitration, kFrameTimeoutCycles);
  run_frames(core, board, patterns, frames, kFrameTimeoutCycles);
  return core.frame_cycles();
}

}  // namespace

PreloadedSystem::PreloadedSystem(const sc_core::sc_module_name& name, const BoardConfig& config,
                                 const Tables& tables, std::uint64_t frames, host::FrameSource& source,
                                 host::FrameSink& sink, Binder& binder, fpga::Fidelity fidelity)
    : sc_module(name),
      board("board", checked(config, tables), binder, fidelity),
      host(
          "host",
          {config.image.width, config.image.height, frames, fpga::has_pixels(fidelity), buffer_bases(config)},
          pointer_to(tables.left), pointer_to(tables.right), source, sink) {
  binder.bind(host.registers, board.core.registers, "host_to_registers");
  binder.bind(host.memory, board.core.local_bus, "host_to_local_bus");
  board.core.done(done_);
  host.done(done_);
}

Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    const KeepGoing& keep_going, std::uint64_t stall_timeout_cycles) {
  if (frames == 0) throw std::invalid_argument("frames = 0: must be 1 or more");
  check_tables(board, tables);
  memory::Arbitration arbitration = arbitration_of(board);
  fpga::FrameRun core(core_config(board), ssram_configs(board), arbitration, stall_timeout_cycles);
  const fpga::AccessPatterns patterns = access_patterns(board, &tables);
  run_frames(core, board, patterns, frames, stall_timeout_cycles, keep_going);
  return collect_statistics(board, frame_accesses(board, patterns), "fast", core.frame_cycles(),
                            counters_of(core, arbitration));
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
