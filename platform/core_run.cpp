#include "platform/core_run.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_timing.h"
#include "models/fpga/frame_counts.h"
#include "models/memory/arbitration.h"
#include "platform/collect.h"

namespace stereotlm::platform {
namespace {

using memory::Port;

std::vector<memory::SsramBankConfig> bank_configs(const BoardConfig& board) {
  std::vector<memory::SsramBankConfig> banks;
  for (const BankConfig& bank : board.banks) banks.push_back(ssram_config(board, bank));
  return banks;
}

class CoreRun {
 public:
  CoreRun(const BoardConfig& board, const Tables& tables)
      : config_(core_config(board)),
        layout_(layout_buffers(board)),
        banks_(bank_configs(board)),
        arbitration_(board.fpga.arbiter, banks_),
        timing_(config_, arbitration_),
        left_(geometry()),
        right_(geometry()) {
    if (tables.left) left_.set_entries(tables.left->entries.data());
    if (tables.right) right_.set_entries(tables.right->entries.data());
    counters_.banks.resize(banks_.size());
  }

  void run_frame(std::uint64_t stall_timeout_cycles) {
    timing_.start_frame(route(frame_cycles_.size()), left_, right_);
    const std::uint64_t first = cycle_;
    arbitration_.begin_counting(first);
    std::uint64_t work = UINT64_MAX;
    while (!control().frame_done()) {
      const std::uint64_t now = control().left().consumed() + control().result().cycles().granted();
      if (now == work) throw_stuck(stall_timeout_cycles);
      work = now;
      cycle_ = timing_.run_ahead(cycle_, cycle_ + stall_timeout_cycles);
    }
    timing_.end_frame();
    arbitration_.end_counting(cycle_);
    cycle_ += static_cast<std::uint64_t>(config_.pipeline_latency_cycles);
    frame_cycles_.push_back(cycle_ - first);
    count_frame();
  }

  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }

  BoardCounters counters() {
    counters_.frames = frame_cycles_.size();
    for (std::size_t port = 0; port < memory::kPortCount; ++port) {
      counters_.ports[port] = control().port_cycles(static_cast<Port>(port));
    }
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      const memory::BankArbiter& arbiter = arbitration_.arbiters()[bank];
      counters_.banks[bank].arbiter = arbiter.stats();
      counters_.banks[bank].uncounted_grants = arbiter.uncounted_accesses();
    }
    counters_.left.consumed = control().left().consumed();
    counters_.right.consumed = control().right().consumed();
    counters_.written_words = control().result().cycles().granted();
    return counters_;
  }

 private:
  const fpga::CoreControl& control() const { return timing_.control(); }
  const fpga::FrameGeometry& geometry() const { return control().geometry(); }

  // The ports to the banks of a frame's buffers.
  fpga::FrameLatencies route(std::uint64_t frame) {
    fpga::FrameLatencies latencies;
    const auto to = [this](Port port, const BufferPlace& place, bool write) {
      const auto bank = static_cast<std::size_t>(place.bank);
      arbitration_.route(port, bank, write);
      return memory::read_latency_cycles(banks_[bank].kind);
    };
    const auto in_turn = [frame](const std::vector<BufferPlace>& list) { return list[frame % list.size()]; };
    if (layout_.left_lut) latencies.left_lut = to(Port::kLeftLut, *layout_.left_lut, false);
    if (layout_.right_lut) latencies.right_lut = to(Port::kRightLut, *layout_.right_lut, false);
    latencies.left_image = to(Port::kLeftPixel, in_turn(layout_.left_image), false);
    latencies.right_image = to(Port::kRightPixel, in_turn(layout_.right_image), false);
    to(Port::kResult, in_turn(layout_.disparity), true);
    return latencies;
  }

  // What slots and tables ask of the banks.
  void count_frame() {
    const fpga::FrameCounts counts(config_, left_, right_, control(), 0);
    const auto access = [this](Port port, std::uint64_t accesses) {
      counters_.banks[arbitration_.bank_of(port)].accesses += accesses;
    };
    access(Port::kLeftLut, counts.left.table.reads);
    access(Port::kRightLut, counts.right.table.reads);
    access(Port::kLeftPixel, counts.left.image.reads);
    access(Port::kRightPixel, counts.right.image.reads);
    access(Port::kResult, geometry().result_words);
    counters_.left.issued += counts.left.slots.slots;
    counters_.right.issued += counts.right.slots.slots;
    counters_.packed_words += counts.packed.words;
  }

  [[noreturn]] void throw_stuck(std::uint64_t stall_timeout_cycles) const {
    throw std::runtime_error(
        fmt::format("frame {} of the core: no slot consumed and no result written for {} cycles",
                    frame_cycles_.size(), stall_timeout_cycles));
  }

  fpga::CoreConfig config_;
  BufferLayout layout_;
  std::vector<memory::SsramBankConfig> banks_;
  memory::Arbitration arbitration_;
  fpga::CoreTiming timing_;
  fpga::AccessPattern left_;
  fpga::AccessPattern right_;
  std::uint64_t cycle_ = 0;
  std::vector<std::uint64_t> frame_cycles_;
  BoardCounters counters_;
};

}  // namespace

Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles) {
  if (frames == 0) throw std::invalid_argument("frames = 0: must be 1 or more");
  check_tables(board, tables);
  CoreRun run(board, tables);
  for (std::uint64_t frame = 0; frame < frames; ++frame) run.run_frame(stall_timeout_cycles);
  return collect_statistics(board, tables, "fast", run.frame_cycles(), run.counters());
}

}  // namespace stereotlm::platform
