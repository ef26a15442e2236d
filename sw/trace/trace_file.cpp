#include "sw/trace/trace_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "models/clock.h"
#include "sw/files/output_file.h"
#include "sw/process/streams.h"
#include "sw/trace/longest_wait.h"
#include "sw/trace/perfetto_writer.h"
#include "sw/trace/sqlite_writer.h"
#include "sw/trace/vcd_writer.h"

namespace stereotlm::trace {
namespace {

// The times of a window that names no frame.
TimeSpan span_of(const fpga::CycleWindow& window, const Clock& clock) {
  const std::uint64_t most_cycles = clock.edge_at_or_after(UINT64_MAX / 4);
  const auto begin_of = [&](std::uint64_t cycle) {
    return cycle < most_cycles ? clock.edge_ps(cycle) : UINT64_MAX;
  };
  return {begin_of(window.first), window.last < most_cycles ? begin_of(window.last + 1) : UINT64_MAX};
}

// Forwards to several writers. For the window of a frame BusTrace reports the whole frame, because the cycles of
// its rows are not known before. Where the longest wait is, is known at the end of the run. In both cases this class
// keeps the bursts and levels, and leaves out those beside the cycles of the window at the end.
class AllWriters : public TraceWriter {
 public:
  AllWriters(std::vector<std::unique_ptr<TraceWriter>> writers, const Clock& clock,
             const std::optional<TraceWindow>& window)
      : writers_(std::move(writers)),
        clock_(clock),
        has_window_(window),
        is_of_frame_(window && window->cycles.frame),
        is_of_wait_(window && window->around_longest_wait) {
    if (is_of_frame_)
      span_ = {UINT64_MAX, 0};
    else if (window)
      span_ = span_of(window->cycles, clock);
  }

  void frame(const platform::FrameRuns& frame) override {
    for (const auto& writer : writers_) writer->frame(frame);
  }
  void events(const platform::TimelineRecords& records) override {
    for (const auto& writer : writers_) writer->events(records);
  }
  void cycle(const fpga::CoreCycle& cycle) override {
    is_empty_ = false;
    if (is_of_frame_) {
      span_.begin_ps = std::min(span_.begin_ps, clock_.edge_ps(cycle.cycle));
      span_.end_ps = clock_.edge_ps(cycle.cycle + 1);
    }
    wait_.add(cycle);
    if (!is_of_wait_) write(cycle);
  }
  void burst(const platform::BusBurst& burst) override {
    is_of_frame_ || is_of_wait_ ? bursts_.push_back(burst) : write(burst);
  }
  void level(const platform::QueueLevel& level) override {
    is_of_frame_ || is_of_wait_ ? levels_.push_back(level) : write(level);
  }
  void complete(const TimeSpan& /*window*/) override {
    if (has_window_ && is_empty_)
      process::say("note", "--trace-window: has no cycle in which a frame ran or the host accessed a bank");
    else if (is_of_wait_ && wait_.cycles() == 0)
      process::say("note", "--trace-window: no port waits in it");
    if (is_of_wait_) {
      for (const fpga::CoreCycle& cycle : wait_.take_kept()) write(cycle);
    }
    set_span();
    for (const platform::BusBurst& burst : bursts_) {
      if (burst.end_ps > span_.begin_ps && burst.request_ps < span_.end_ps) write(burst);
    }
    for (const platform::QueueLevel& level : levels_) {
      if (level.time_ps > span_.begin_ps && level.time_ps <= span_.end_ps) write(level);
    }
    for (const auto& writer : writers_) writer->complete(span_);
  }
  void commit() override {
    for (const auto& writer : writers_) writer->commit();
  }

 private:
  // All cycles are known.
  void set_span() {
    if (span_.begin_ps > span_.end_ps || (is_of_wait_ && wait_.cycles() == 0)) span_ = {0, 0};
    if (wait_.cycles() == 0) return;
    span_.wait_ps = clock_.edge_ps(wait_.first_cycle());
    if (!is_of_wait_) return;
    span_.begin_ps = clock_.edge_ps(wait_.begin_around());
    span_.end_ps = std::min(span_.end_ps, clock_.edge_ps(wait_.end_around()));
  }
  void write(const fpga::CoreCycle& cycle) {
    for (const auto& writer : writers_) writer->cycle(cycle);
  }
  void write(const platform::BusBurst& burst) {
    for (const auto& writer : writers_) writer->burst(burst);
  }
  void write(const platform::QueueLevel& level) {
    for (const auto& writer : writers_) writer->level(level);
  }

  std::vector<std::unique_ptr<TraceWriter>> writers_;
  Clock clock_;
  bool has_window_;
  bool is_of_frame_;
  bool is_of_wait_;
  bool is_empty_ = true;  // no cycle has come
  TimeSpan span_;         // of the window; in that of a frame: of its cycles so far
  LongestWait wait_;
  // In the window of a frame or of a wait: what the buses do in the cycles from which it is taken.
  std::vector<platform::BusBurst> bursts_;
  std::vector<platform::QueueLevel> levels_;
};

std::unique_ptr<TraceWriter> make_writer(const TraceFile& file, const platform::BoardConfig& board) {
  switch (file.format) {
    case Format::kPerfetto:
      return std::make_unique<PerfettoWriter>(file.path, board);
    case Format::kVcd:
      return std::make_unique<VcdWriter>(file.path, board);
    case Format::kSqlite:
      break;
  }
  return std::make_unique<SqliteWriter>(file.path, board);
}

}  // namespace

std::vector<std::filesystem::path> outputs_of(const TraceFile& file) {
  namespace fs = std::filesystem;
  std::vector<fs::path> outputs = {file.path};
  if (file.format == Format::kVcd) outputs.push_back(VcdWriter::layout_of(file.path));
  for (fs::path& output : outputs) output = fs::weakly_canonical(files::linked_file(fs::absolute(output)));
  return outputs;
}

std::unique_ptr<TraceWriter> make_writer(const std::vector<TraceFile>& files,
                                         const platform::BoardConfig& board,
                                         const std::optional<TraceWindow>& window) {
  std::vector<std::unique_ptr<TraceWriter>> writers;
  for (const TraceFile& file : files) {
    writers.push_back(make_writer(file, board));
  }
  return std::make_unique<AllWriters>(std::move(writers), Clock(board.fpga.clock_mhz), window);
}

}  // namespace stereotlm::trace
