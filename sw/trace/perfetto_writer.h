#pragma once

#include <filesystem>

#include "sw/files/output_file.h"
#include "sw/trace/perfetto_computer.h"
#include "sw/trace/perfetto_cycles.h"
#include "sw/trace/perfetto_rows.h"
#include "sw/trace/perfetto_tree.h"
#include "sw/trace/trace_board.h"
#include "sw/trace/trace_writer.h"

namespace stereotlm::trace {

// Writes a trace for ui.perfetto.dev. README.md describes its tracks.
class PerfettoWriter : public TraceWriter {
 public:
  PerfettoWriter(const std::filesystem::path& path, const platform::BoardConfig& board);

  void cycle(const fpga::CoreCycle& cycle) override { cycles_.cycle(cycle); }
  void burst(const platform::BusBurst& burst) override { computer_.burst(burst); }
  void level(const platform::QueueLevel& level) override { computer_.level(level); }
  void frame(const platform::FrameRuns& frame) override { rows_.frame(frame); }
  void events(const platform::TimelineRecords& records) override;
  void complete(const TimeSpan& window) override;
  void commit() override;

 private:
  TraceBoard board_;
  files::OutputFile file_;
  PerfettoTree tree_;
  PerfettoRows rows_;
  PerfettoCycles cycles_;
  PerfettoComputer computer_;
};

}  // namespace stereotlm::trace
