#include "sw/trace/perfetto_writer.h"

namespace stereotlm::trace {

PerfettoWriter::PerfettoWriter(const std::filesystem::path& path, const platform::BoardConfig& board)
    : board_(board),
      file_(path, files::marked_kind("Perfetto trace of stereotlm", {{0, perfetto_mark()}})),
      tree_(file_, "stereotlm " + board.name),
      rows_(board_, tree_),
      cycles_(board_, tree_),
      computer_(tree_) {}

void PerfettoWriter::events(const platform::TimelineRecords& records) {
  for (const platform::TimelineEvent& event : records.events) computer_.event(event);
}

void PerfettoWriter::complete(const TimeSpan& /*window*/) {
  cycles_.end();
  file_.complete();
}

void PerfettoWriter::commit() { file_.commit(); }

}  // namespace stereotlm::trace
