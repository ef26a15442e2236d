#include "platform/core_run.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/buffer_bases.h"
#include "models/fpga/frame_run.h"
#include "models/memory/arbitration.h"
#include "platform/collect.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

// Runs frames for run_core(), and sums their counts.
class CoreRun {
 public:
  CoreRun(const BoardConfig& board, const Tables& tables, std::uint64_t stall_timeout_cycles)
      : config_(core_config(board)),
        buffers_(buffer_bases(board)),
        banks_(ssram_configs(board)),
        stall_timeout_cycles_(stall_timeout_cycles),
        arbitration_(board.fpga.arbiter, banks_),
        frames_(config_, banks_, arbitration_, stall_timeout_cycles) {
    if (tables.left) patterns_[0].set_entries(tables.left->entries.data());
    if (tables.right) patterns_[1].set_entries(tables.right->entries.data());
  }

  void run_frame() {
    frames_.start_direct(frames_.done_cycle(), buffers_.of_frame(frame_cycles().size()), patterns_);
    while (!frames_.control().frame_done()) {
      frames_.run_ahead(frames_.cycle() + stall_timeout_cycles_);
      if (frames_.stalled_cycles() != 0) throw_stuck();
    }
    frames_.finish();
    frames_.end();
  }

  const std::vector<std::uint64_t>& frame_cycles() const { return frames_.frame_cycles(); }

  BoardCounters counters() const { return counters_of(frames_, arbitration_.arbiters()); }

 private:
  [[noreturn]] void throw_stuck() const {
    throw std::runtime_error(
        fmt::format("frame {} of the core: no slot consumed and no result written for {} cycles",
                    frame_cycles().size(), stall_timeout_cycles_));
  }

  fpga::CoreConfig config_;
  fpga::BufferBases buffers_;
  std::vector<memory::SsramBankConfig> banks_;
  std::uint64_t stall_timeout_cycles_;
  memory::Arbitration arbitration_;
  fpga::FrameRun frames_;
  fpga::AccessPatterns patterns_{fpga::AccessPattern(frames_.control().geometry(), config_.pixel_cache),
                                 fpga::AccessPattern(frames_.control().geometry(), config_.pixel_cache)};
};

}  // namespace

Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles) {
  if (frames == 0) throw std::invalid_argument("frames = 0: must be 1 or more");
  check_tables(board, tables);
  CoreRun run(board, tables, stall_timeout_cycles);
  for (std::uint64_t frame = 0; frame < frames; ++frame) run.run_frame();
  return collect_statistics(board, frame_accesses(board, tables), "fast", run.frame_cycles(), run.counters());
}

}  // namespace stereotlm::platform
