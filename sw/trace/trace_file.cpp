#include "sw/trace/trace_file.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "models/clock.h"
#include "sw/trace/perfetto_writer.h"
#include "sw/trace/sqlite_writer.h"
#include "sw/trace/vcd_writer.h"

namespace stereotlm::trace {
namespace {

// Hands everything to several writers. In the window of a frame the buses are traced for the whole frame, because
// the cycles of its rows are not known before; here what lies beside the cycles of the window is left out.
class AllWriters : public TraceWriter {
 public:
  AllWriters(std::vector<std::unique_ptr<TraceWriter>> writers, const Clock& clock, bool is_of_frame)
      : writers_(std::move(writers)), clock_(clock), is_of_frame_(is_of_frame) {}

  void frame(const platform::FrameRuns& frame) override {
    for (const auto& writer : writers_) writer->frame(frame);
  }
  void events(const platform::TimelineRecords& records) override {
    for (const auto& writer : writers_) writer->events(records);
  }
  void cycle(const fpga::CoreCycle& cycle) override {
    begin_ps_ = std::min(begin_ps_, clock_.edge_ps(cycle.cycle));
    end_ps_ = clock_.edge_ps(cycle.cycle + 1);
    for (const auto& writer : writers_) writer->cycle(cycle);
  }
  void burst(const platform::BusBurst& burst) override {
    is_of_frame_ ? bursts_.push_back(burst) : write(burst);
  }
  void level(const platform::QueueLevel& level) override {
    is_of_frame_ ? levels_.push_back(level) : write(level);
  }
  void commit() override {
    for (const platform::BusBurst& burst : bursts_) {
      if (burst.end_ps > begin_ps_ && burst.request_ps < end_ps_) write(burst);
    }
    for (const platform::QueueLevel& level : levels_) {
      if (level.time_ps > begin_ps_ && level.time_ps <= end_ps_) write(level);
    }
    for (const auto& writer : writers_) writer->commit();
  }

 private:
  void write(const platform::BusBurst& burst) {
    for (const auto& writer : writers_) writer->burst(burst);
  }
  void write(const platform::QueueLevel& level) {
    for (const auto& writer : writers_) writer->level(level);
  }

  std::vector<std::unique_ptr<TraceWriter>> writers_;
  Clock clock_;
  bool is_of_frame_;
  // The cycles of the window: the beginning of the first one, and the end of the last one so far.
  std::uint64_t begin_ps_ = UINT64_MAX;
  std::uint64_t end_ps_ = 0;
  // In the window of a frame: what the buses do in that frame, because it may come before the cycles.
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

std::unique_ptr<TraceWriter> make_writer(const std::vector<TraceFile>& files,
                                         const platform::BoardConfig& board,
                                         const std::optional<fpga::CycleWindow>& window) {
  std::vector<std::unique_ptr<TraceWriter>> writers;
  for (const TraceFile& file : files) writers.push_back(make_writer(file, board));
  return std::make_unique<AllWriters>(std::move(writers), Clock(board.fpga.clock_mhz),
                                      window && window->frame);
}

}  // namespace stereotlm::trace
