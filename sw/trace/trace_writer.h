#pragma once

#include <cstdint>
#include <optional>

#include "models/fpga/core_cycle.h"
#include "platform/timeline_records.h"
#include "platform/trace_records.h"

namespace stereotlm::trace {

// Times from `begin_ps` on, up to `end_ps`.
struct TimeSpan {
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = UINT64_MAX;
  std::optional<std::uint64_t> wait_ps = std::nullopt;  // the longest wait of a port in it begins
};

// Writes a trace of a run to a file, which appears whole with commit() or not at all. Memory does not grow with
// the run. Every function throws std::runtime_error, with the name of the file, if a byte cannot be stored.
//
// Cycles, bursts and levels come from the window of the trace only. The names in bursts and levels must be valid
// until complete() returns.
class TraceWriter : public fpga::CycleObserver, public platform::BusObserver {
 public:
  // A frame of the core has ended.
  virtual void frame(const platform::FrameRuns& frame) = 0;
  // Events of the computer, in the order of their ends.
  virtual void events(const platform::TimelineRecords& records) = 0;
  // Ends the trace and makes the file durable, under another name. To be called after everything above. `window`:
  // the time of the window.
  virtual void complete(const TimeSpan& window) = 0;
  // Replaces an earlier file. To be called after complete(). Files that belong together are all completed before
  // the first of them is committed.
  virtual void commit() = 0;
};

}  // namespace stereotlm::trace
