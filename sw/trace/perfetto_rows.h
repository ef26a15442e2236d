#pragma once

#include <cstdint>
#include <vector>

#include "platform/trace_records.h"
#include "sw/trace/perfetto_tree.h"
#include "sw/trace/trace_board.h"

namespace stereotlm::trace {

// The frames of the core: a slice for each frame, each strip, and each run of a strip. The slices of a port in
// a strip stand one behind the other, first the accesses, then the waits, each as long as its cycles.
class PerfettoRows {
 public:
  PerfettoRows(const TraceBoard& board, PerfettoTree& tree);

  void frame(const platform::FrameRuns& frame);

 private:
  // The runs of one strip.
  struct Strip {
    std::size_t number;
    std::uint64_t first_cycle;
    std::uint64_t end_cycle;
    const platform::TraceRun* begin;
    const platform::TraceRun* end;
    std::uint64_t first_flow;  // of the first run; the next ones follow
  };
  // A track with the first cycle that is free on it.
  struct Row {
    LazyTrack track;
    std::uint64_t free_cycle = 0;
  };

  void write_strip(const Strip& strip);
  void write_grant(const Strip& strip, const platform::TraceRun& run);
  void write_wait(const Strip& strip, const platform::TraceRun& run);
  void write_run(Row& row, const platform::TraceRun& run, std::string_view name,
                 const std::vector<std::uint64_t>& flows);
  void write_counters(const Strip& strip);
  void end_counters(std::uint64_t end_cycle);
  std::string name_of(std::size_t strip) const;
  std::uint64_t ns(std::uint64_t cycle) const { return board_.ps(cycle) / 1000; }

  const TraceBoard& board_;
  LazyTrack frames_;
  LazyTrack strips_;
  std::vector<Row> ports_;             // [requester]
  std::vector<LazyTrack> port_waits_;  // [requester]
  std::vector<Row> banks_;             // [2 * bank + 1 if its accesses write to a bank with separate ports]
  std::vector<LazyTrack> bank_use_;    // [bank]
  std::uint64_t next_flow_ = 1;
};

}  // namespace stereotlm::trace
