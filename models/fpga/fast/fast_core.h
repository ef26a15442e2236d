#pragma once

#include <cstdint>
#include <string>

#include "models/clock.h"
#include "models/fpga/core_registers.h"
#include "models/fpga/fast/direct_frame.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/host_port.h"
#include "models/fpga/local_bus_control.h"
#include "models/memory/direct_banks.h"
#include "models/time_ps.h"

namespace stereotlm::fpga {

// Fast-forwards the core beside the bursts of the local bus, for Fidelity::kFast and kTiming. It advances a
// frame in two cases: a word at the local bus contends for a bank of the frame, or the frame may have ended.
// The frame works directly on memory:
// - It reads pictures and tables at the start strobe, all at once.
// - It writes all disparities at once: at the time of its last write, or earlier, but never before a pending
//   event that could observe them.
// - A burst of the local bus that could observe this is a hazard: it writes what the frame reads, or reads or
//   writes the disparities.
// Plain C++.
class FastCore {
 public:
  // What the core is built into.
  class Board {
   public:
    virtual ~Board() = default;
    // No other event can happen before this time. It is the present or later.
    virtual std::uint64_t horizon_ps() const = 0;
    // The frame has ended, now. `failed`: its result may differ from that at Fidelity::kCycle.
    virtual void frame_ended(bool failed) = 0;
    // The result of the running frame may differ from that at Fidelity::kCycle.
    virtual void failed(const std::string& why) = 0;
    // The frame has made no progress for this number of cycles.
    virtual void stalled(std::uint64_t cycles) = 0;
  };

  // `has_pixels`: whether disparities are computed. The other arguments outlive this object.
  FastCore(const CoreConfig& config, bool has_pixels, FrameRun& frames, HostPort& host_port,
           LocalBusControl& local_bus, memory::DirectBanks& banks, const Clock& clock, Board& board);

  // Starts the frame of a strobe in `cycle`, the first that begins at or after the strobe. Returns false if
  // the frame must be stepped, and starts none: memory grants no direct access, buffers overlap, tables
  // point outside the image, or a burst runs that is a hazard.
  bool start_frame(std::uint64_t cycle, const FrameStart& start);
  // To be called instead of HostPort::route() unless a stepped frame runs.
  void route(const HostRoute& route);

  // Does what is due at `now_ps`. Returns the time of the next call; kNever: when a frame starts. A call is
  // also due when a burst begins to request. An event at the time of an edge belongs to the cycle that begins
  // there.
  std::uint64_t advance(std::uint64_t now_ps);

 private:
  bool works_directly(const FrameStart& start);
  void end_frame();
  void report_hazard(const HostRoute& burst, std::size_t group);
  void fail(const std::string& why);

  FrameRun& frames_;
  HostPort& host_port_;
  LocalBusControl& local_bus_;
  const Clock& clock_;
  Board& board_;
  DirectFrame direct_frame_;
  bool failed_ = false;              // the result of the frame may differ from that at Fidelity::kCycle
  std::uint64_t next_check_ps_ = 0;  // the frame cannot have ended before this time
};

}  // namespace stereotlm::fpga
