#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/fpga/record/core_cycle.h"
#include "platform/config/board_config.h"
#include "sw/trace/trace_sink.h"

namespace stereotlm::trace {

// Finds the longest wait of a port for a bank. Keeps its cycles and 60 around it: n before it and 60 - n
// behind it, where n is 30, or less if fewer cycles came before. Of equal waits it takes the first one with
// n = 30, else the last one.
class LongestWait {
 public:
  // Cycles in their order. A missing cycle ends every wait.
  void add(const fpga::CoreCycle& cycle);

  // The length of the longest wait; 0: no port waits.
  std::uint64_t cycles() const { return end_ - first_; }
  std::uint64_t first_cycle() const { return first_; }
  // The first cycle around the wait, and the first one behind them.
  std::uint64_t begin_around() const { return lacks_cycles_before() ? first_added_ : first_ - kBefore; }
  std::uint64_t end_around() const { return begin_around() + cycles() + kBeside; }
  // The cycles around the wait that were added. To be called once, after the last add().
  std::deque<fpga::CoreCycle> take_kept();

 private:
  static constexpr std::uint64_t kBefore = 30;
  static constexpr std::uint64_t kBeside = 60;

  bool lacks_cycles_before() const { return first_ < first_added_ + kBefore; }

  std::uint64_t first_added_ = 0;
  std::uint64_t next_cycle_ = 0;       // 0: none was added
  std::vector<std::uint64_t> waited_;  // [port]: cycles of the wait that is under way
  std::uint64_t first_ = 0;
  std::uint64_t end_ = 0;
  bool grows_ = false;                  // it is under way
  std::deque<fpga::CoreCycle> recent_;  // with those before the waits that are under way
  std::deque<fpga::CoreCycle> kept_;    // with those behind the longest wait, if that has ended
};

// A file that a run is to write.
struct TraceFile {
  const TraceFormat* format;
  std::string path;
};

// The files of the trace, behind links. Throws std::system_error if links cannot be followed.
std::vector<std::filesystem::path> outputs_of(const TraceFile& file);

// What the window of a trace shows: these cycles, or those of them around the longest wait of a port.
struct TraceWindow {
  fpga::CycleWindow cycles;
  bool around_longest_wait = false;
};

// The traces of a run. Its files appear whole with commit(), or not at all.
//
// The sinks get the cycles, bursts and levels of the window. If the window names a frame, BusTrace reports
// the whole frame, because it is not known in advance when the rows of a window begin. The longest wait is
// known only at the end of the run. So with both kinds of window this class keeps the bursts and levels, and
// at the end leaves out those outside the window.
class Trace : public fpga::CycleObserver, public platform::BusObserver {
 public:
  // All functions throw std::runtime_error, with the name of the file, if one cannot be written.
  Trace(const std::vector<TraceFile>& files, const platform::BoardConfig& board,
        const std::optional<TraceWindow>& window);
  const std::optional<TraceWindow>& window() const { return window_; }

  void cycle(const fpga::CoreCycle& cycle) override;
  void burst(const platform::BusBurst& burst) override;
  void level(const platform::QueueLevel& level) override;
  void frame(const platform::FrameRuns& frame);  // left out if the window has none of its cycles
  void events(const platform::TimelineRecords& records);
  // Ends the traces and makes the files durable, under other names. To be called after everything above.
  void complete();
  // Replaces earlier files. To be called after complete().
  void commit();

 private:
  // `event`: the function of the sinks that takes the record.
  template <typename Event, typename Record>
  void write(Event event, const Record& record) {
    for (const auto& sink : sinks_) (*sink.*event)(record);
  }

  std::vector<std::unique_ptr<TraceSink>> sinks_;
  Clock clock_;
  std::optional<TraceWindow> window_;
  bool is_of_frame_;
  bool is_of_wait_;
  bool is_empty_ = true;  // no cycle has come
  TimeSpan span_;         // of the window; in that of a frame: of its cycles so far
  LongestWait wait_;
  // In the window of a frame or of a wait: what the buses do in the cycles from which it is taken.
  std::vector<platform::BusBurst> bursts_;
  std::vector<platform::QueueLevel> levels_;
};

}  // namespace stereotlm::trace
