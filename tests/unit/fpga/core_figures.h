#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/stereo_core.h"

namespace stereotlm::fpga {

// All that a core counts but the accesses of its banks, one line for each block: to be compared as a whole.
class CoreFigures {
 public:
  explicit CoreFigures(const StereoCore& core) {
    line("frame_cycles", core.frame_cycles());
    for (std::size_t index = 0; index < memory::kPortCount; ++index) {
      const PortCycles& port = core.control().port_cycles(static_cast<memory::Port>(index));
      line(memory::kPortNames[index],
           {port.granted(), port.stalled(), port.passed(), port.idle(), port.blocked(), port.starved()});
    }
    for (const memory::BankArbiter& arbiter : core.crossbar().arbiters()) add(arbiter);
    const LocalBus::Stats bus = core.local_bus_port().stats();
    line("local bus", {bus.bursts, bus.words_read, bus.words_written, bus.register_accesses, bus.errors,
                       bus.clocks, bus.busy_clocks});
    add_stages(core);
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
  void add_stages(const StereoCore& core) {
    for (const Side side : {Side::kLeft, Side::kRight}) {
      const Sequencer::Stats slots = core.sequencer().stats(side);
      line("slots", {slots.slots, slots.empty_slots});
    }
    for (const LutReader* reader : {core.left_lut_reader(), core.right_lut_reader()}) {
      if (reader == nullptr) continue;
      const LutReader::Stats stats = reader->stats();
      line("table", {stats.reads, stats.invalid_entries, stats.empty_slots, stats.errors});
    }
    for (const PixelReader* reader : {&core.left_pixel_reader(), &core.right_pixel_reader()}) {
      const PixelReader::Stats stats = reader->stats();
      line("image", {stats.reads, stats.passed_slots, stats.errors});
    }
    for (const LogFilter* filter : {&core.left_filter(), &core.right_filter()})
      line("filter", {filter->stats().pixels, filter->stats().columns});
    for (const RowBuffer* rows : {core.left_row_buffer(), core.right_row_buffer()}) {
      if (rows != nullptr) line("rows", {rows->stats().columns});
    }
    const SadArray::Stats sums = core.sad_array().stats();
    line("sums", {sums.columns, sums.absolute_differences, sums.candidates});
    line("chain", {core.select_min_chain().stats().columns, core.select_min_chain().stats().matches});
    line("tree", {core.select_min_tree().stats().columns, core.select_min_tree().stats().matches});
    line("check", {core.lr_check().stats().answered, core.lr_check().stats().invalid});
    line("packer", {core.result_packer().stats().words});
    const ResultWriter::Stats writer = core.result_writer().stats();
    line("writer", {writer.writes, writer.most_queued_words, writer.errors});
  }

  std::string text_;
};

}  // namespace stereotlm::fpga
