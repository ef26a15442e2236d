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
  CoreFigures(const FrameRun& frames, const memory::Arbitration& arbitration) {
    line("frame_cycles", frames.frame_cycles());
    const CorePorts& ports = frames.control().ports();
    for (std::size_t index = 0; index < ports.size(); ++index) {
      const PortCycles& port = frames.control().port_cycles(index);
      line(ports.name(index),
           {port.granted(), port.stalled(), port.passed(), port.idle(), port.blocked(), port.starved()});
    }
    for (std::size_t bank = 0; bank < arbitration.banks(); ++bank) add(arbitration.stats(bank));
    for (const LaneControl& lane : frames.control().lanes()) line("consumed", {lane.consumed()});
  }
  explicit CoreFigures(const StereoCore& core) : CoreFigures(core.frames(), core.crossbar().arbitration()) {
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
  void add(const memory::ArbiterStats& stats) {
    line("bank", {stats.reads(), stats.writes(), stats.turnaround_cycles(), stats.idle_cycles(),
                  stats.contended_cycles(), stats.uncounted_accesses()});
    for (memory::Port port = 0; port < kGroupCount; ++port) {
      line("  grants", {stats.grants(port)});
      for (std::size_t by = 0; by <= kGroupCount; ++by) line("  blame", {stats.blame(port, by)});
    }
  }
  std::string text_;
};

}  // namespace stereotlm::fpga
