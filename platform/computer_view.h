#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/frame_run.h"
#include "models/fpga/row_profile.h"
#include "platform/bus_trace.h"
#include "platform/collect_computer.h"
#include "platform/timeline.h"

namespace stereotlm::platform {

// What Computer and FastComputer show of a run.
class ComputerView {
 public:
  virtual ~ComputerView() = default;
  // To be called while the core runs no frame.
  virtual ComputerCounters counters() const = 0;
  virtual const fpga::FrameRun& core_frames() const = 0;
  // A measure of progress towards a result. It advances a running frame to the present.
  virtual std::uint64_t work_done() = 0;
  // Text for messages: what the ports of the core wait for.
  virtual std::string waits() = 0;
  // Hands everything that happens to `timeline`, which outlives the computer. To be called at time 0.
  virtual void record(Timeline& timeline) = 0;
  // Hands what the buses and the queues do to `trace`, which outlives the computer. To be called at time 0.
  virtual void trace_buses(BusTrace& trace) = 0;
  // See FrameRun.
  virtual void record(fpga::ConflictRecorder& conflicts) = 0;
  virtual void record(fpga::CycleRecorder& cycles) = 0;
  virtual void record_rows() = 0;
  virtual std::vector<fpga::RowProfile> take_rows() = 0;
};

}  // namespace stereotlm::platform
