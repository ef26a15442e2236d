#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/trace/change_stream.h"
#include "sw/trace/trace_board.h"
#include "sw/trace/trace_writer.h"
#include "sw/trace/vcd_signals.h"
#include "sw/trace/vcd_text.h"

namespace stereotlm::trace {

// Writes the window of a trace as a waveform, and a save file of GTKWave beside it. README.md describes the
// signals.
class VcdWriter : public TraceWriter {
 public:
  // A path that ends in ".fst" gives the format of GTKWave, through its program vcd2fst; another one gives VCD.
  // Throws std::runtime_error also if vcd2fst is needed and not installed, and if the path ends in ".gtkw".
  VcdWriter(const std::filesystem::path& path, const platform::BoardConfig& board);
  // The save file of GTKWave beside the waveform.
  static std::filesystem::path layout_of(std::filesystem::path path) {
    return path.replace_extension(".gtkw");
  }
  static bool is_fst(const std::filesystem::path& path) { return path.extension() == ".fst"; }

  void cycle(const fpga::CoreCycle& cycle) override;
  void burst(const platform::BusBurst& burst) override;
  void level(const platform::QueueLevel& level) override;
  // A waveform shows the window alone.
  void frame(const platform::FrameRuns& /*frame*/) override {}
  void events(const platform::TimelineRecords& /*records*/) override {}
  void complete(const TimeSpan& window) override;
  void commit() override;

 private:
  // Words that cycles show.
  struct Words {
    std::array<std::uint32_t, 2> accesses;  // [write]
    std::array<std::uint32_t, 5> intents;   // [fpga::Intent]
    std::array<std::uint32_t, fpga::kRequesters + 1> requesters;
    std::vector<std::uint32_t> banks;
    std::array<std::uint32_t, fpga::kHostTraffics> traffics;
  };

  Words make_words();
  void end_cycles();
  void show_idle();
  void show_port(const fpga::CoreCycle& cycle, std::size_t port);
  void show_bank(const fpga::PortCycle& port, std::size_t requester);
  void add_changes(std::uint64_t cycle);
  VcdSpan write_waveform(const std::vector<ChangeStream*>& streams, const TimeSpan& window);

  std::filesystem::path path_;
  TraceBoard board_;
  VcdSignals signals_;
  Words words_;
  files::OutputFile file_;
  std::optional<files::OutputFile> layout_;  // nothing: the user has a layout of this name
  std::vector<std::uint32_t> idle_;          // [signal of the core]
  std::vector<std::uint32_t> now_;
  std::vector<std::uint32_t> shown_;
  std::optional<std::uint64_t> next_cycle_;  // the one behind the last cycle
  ChangeStream core_;
  std::deque<ChangeStream> buses_;   // [BusBurst::Bus]
  std::deque<ChangeStream> queues_;  // one for each
};

}  // namespace stereotlm::trace
