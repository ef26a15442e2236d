#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "models/fpga/record/core_cycle.h"
#include "platform/config/board_config.h"
#include "platform/records/timeline_records.h"
#include "platform/records/trace_records.h"
#include "sw/files/output_file.h"

namespace stereotlm::trace {

// Times from `begin_ps` on, up to `end_ps`.
struct TimeSpan {
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = UINT64_MAX;
  std::optional<std::uint64_t> wait_ps = std::nullopt;  // the longest wait of a port in it begins
};

// Writes the events of a run in one format. Memory does not grow with the run. Every function throws
// std::runtime_error, with the name of the file, if a byte cannot be stored.
//
// Cycles, bursts and levels come from the window of the trace only. The names in bursts and levels must be
// valid until end() returns.
class TraceSink : public fpga::CycleObserver, public platform::BusObserver {
 public:
  // A frame of the core has ended.
  virtual void frame(const platform::FrameRuns& /*frame*/) {}
  // Events of the computer come in the order of their ends.
  virtual void event(const platform::TimelineEvent& /*event*/) {}
  // The events are complete. Writes what is left to the files. `window`: the time of the window.
  virtual void end(const TimeSpan& window) = 0;
  // The files of the trace. After end() they only have to be completed and committed.
  std::deque<files::OutputFile>& files() { return files_; }

 protected:
  std::deque<files::OutputFile> files_;
};

// A format. Its sink is made for the file at `path`; that throws std::runtime_error, with the name of the
// file, if the file cannot be written.
struct TraceFormat {
  const char* name;  // on the command line
  std::unique_ptr<TraceSink> (*make_sink)(const std::filesystem::path& path,
                                          const platform::BoardConfig& board);
  const char* second_file = nullptr;  // the ending of a file that is written beside the trace
  bool needs_window = false;          // the trace shows the window alone
};

// ui.perfetto.dev. README.md describes the tracks.
std::unique_ptr<TraceSink> perfetto_sink(const std::filesystem::path& path,
                                         const platform::BoardConfig& board);
// A waveform, and a save file of GTKWave beside it. README.md describes the signals. A path that ends in
// ".fst" gives the format of GTKWave, through its program vcd2fst; another one gives VCD. Throws
// std::runtime_error also if vcd2fst is needed and not installed, and if the path ends in ".gtkw".
std::unique_ptr<TraceSink> vcd_sink(const std::filesystem::path& path, const platform::BoardConfig& board);
// An SQLite database. Its schema says what each table and each column holds; README.md has queries.
std::unique_ptr<TraceSink> sqlite_sink(const std::filesystem::path& path, const platform::BoardConfig& board);

// All formats. A new one is a file NAME_sink.cpp, its declaration above, a row here, and a test.
inline constexpr TraceFormat kTraceFormats[] = {
    {"perfetto", perfetto_sink}, {"vcd", vcd_sink, ".gtkw", true}, {"sqlite", sqlite_sink}};

}  // namespace stereotlm::trace
