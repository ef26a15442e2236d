#include "sw/trace/trace_file.h"

#include <utility>

#include "sw/trace/perfetto_writer.h"
#include "sw/trace/sqlite_writer.h"
#include "sw/trace/vcd_writer.h"

namespace stereotlm::trace {
namespace {

// Hands everything to several writers.
class AllWriters : public TraceWriter {
 public:
  explicit AllWriters(std::vector<std::unique_ptr<TraceWriter>> writers) : writers_(std::move(writers)) {}

  void frame(const platform::FrameRuns& frame) override {
    for (const auto& writer : writers_) writer->frame(frame);
  }
  void events(const platform::TimelineRecords& records) override {
    for (const auto& writer : writers_) writer->events(records);
  }
  void cycle(const fpga::CoreCycle& cycle) override {
    for (const auto& writer : writers_) writer->cycle(cycle);
  }
  void burst(const platform::BusBurst& burst) override {
    for (const auto& writer : writers_) writer->burst(burst);
  }
  void level(const platform::QueueLevel& level) override {
    for (const auto& writer : writers_) writer->level(level);
  }
  void commit() override {
    for (const auto& writer : writers_) writer->commit();
  }

 private:
  std::vector<std::unique_ptr<TraceWriter>> writers_;
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
                                         const platform::BoardConfig& board) {
  std::vector<std::unique_ptr<TraceWriter>> writers;
  for (const TraceFile& file : files) writers.push_back(make_writer(file, board));
  return std::make_unique<AllWriters>(std::move(writers));
}

}  // namespace stereotlm::trace
