#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/stereo_core.h"

namespace stereotlm::fpga {

// All that a core counts at every fidelity, one line for each block: to be compared as a whole. (Stages count
// only the data that moves through them.)
class CoreFigures {
 public:
  CoreFigures(const FrameRun& frames, const std::vector<memory::BankArbiter>& arbiters) {
    line("frame_cycles", frames.frame_cycles());
    for (std::size_t index = 0; index < kPortCount; ++index) {
      const PortCycles& port = frames.control().port_cycles(index);
      line(kPorts[index].name,
           {port.granted(), port.stalled(), port.passed(), port.idle(), port.blocked(), port.starved()});
    }
    for (const memory::BankArbiter& arbiter : arbiters) add(arbiter);
    for (const Side side : kSides) line("consumed", {frames.control().lane(side).consumed()});
  }
  explicit CoreFigures(const StereoCore& core) : CoreFigures(core.frames(), core.crossbar().arbiters()) {
    const LocalBus::Stats bus = core.local_bus_port().stats();
    line("local bus", {bus.bursts, bus.words_read, bus.words_written, bus.register_accesses, bus.errors,
                       bus.clocks, bus.busy_clocks});
  }
  void add(const RowProfile& rows) {
    for (const RowEnd& row : rows) {
      line("row complete", {row.cycles});
      line("  stalls", {row.stalls.begin(), row.stalls.end()});
    }
  }
  const std::string& text() const { return text_; }

 private:
  void line(const std::string& name, const std::vector<std::uint64_t>& values) {
    text_ += name + ':';
    for (const std::uint64_t value : values) text_ += ' ' + std::to_string(value);
    text_ += '\n';
  }
  void add(const memory::BankArbiter& arbiter) {
    const memory::ArbiterStats stats = arbiter.stats();
    line("bank", {stats.reads, stats.writes, stats.turnaround_cycles, stats.idle_cycles,
                  stats.contended_cycles, arbiter.uncounted_accesses()});
    line("  grants", {stats.grants.begin(), stats.grants.end()});
    for (const auto& row : stats.blame) line("  blame", {row.begin(), row.end()});
  }
  std::string text_;
};

}  // namespace stereotlm::fpga
