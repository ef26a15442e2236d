#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/fpga/core_stepper.h"
#include "models/fpga/fast_forward.h"
#include "models/fpga/row_profile.h"
#include "models/fpga/stall_watchdog.h"

namespace stereotlm::fpga {

// The frames of a core, one after another, in cycles of its clock: the ports' routes to the banks, the cycles
// of a frame, and its progress. Plain C++, for StereoCore and for platform::run_core().
//
// A frame runs up to its last write; then finish() is to be called. After pipeline_latency_cycles more it
// ends; then end() is to be called.
class FrameRun {
 public:
  // `arbitration` outlives this object. `most_groups`: cap of the transition cache. Throws
  // std::invalid_argument if the configuration has problems.
  FrameRun(const CoreConfig& config, const std::vector<memory::SsramBankConfig>& banks,
           memory::Arbitration& arbitration, std::uint64_t stall_timeout_cycles,
           std::size_t most_groups = TransitionCache::kMost);

  bool has_bank(std::uint32_t base) const { return registers::bank_of(base) < latencies_.size(); }
  int read_latency_cycles(std::size_t bank) const { return latencies_[bank]; }

  // Starts a frame in `cycle`, or in cycle() if that is later. The banks of the bases exist.
  // With data: the caller steps it, and moves the data of each cycle.
  void start_with_data(std::uint64_t cycle, const FrameBases& bases);
  // Without data: it runs ahead with these accesses. The patterns outlive the frame.
  void start(std::uint64_t cycle, const FrameBases& bases, const AccessPatterns& patterns);

  // Runs cycle(), in which the host requests or not. `move` is that of CoreStepper::step().
  template <class Move>
  memory::PortMask step(bool host_requests, const Move& move) {
    return stepper_.step(cycle_++, host_requests, move);
  }
  // The same for a frame without data.
  memory::PortMask step(bool host_requests) { return fast_forward_.step(cycle_++, host_requests); }
  // Runs the cycles of a frame without data up to `end`, `end` not included, or until the frame is done.
  void run_ahead(std::uint64_t end) { cycle_ = fast_forward_.run_ahead(cycle_, end); }
  // No frame runs: `cycle` is the next to run.
  void skip_to(std::uint64_t cycle) { cycle_ = cycle; }
  // To be called before the route of the host changes.
  void host_route_changes() { fast_forward_.settle(); }
  // The last write has been granted in the cycle before cycle().
  void finish();
  void end();

  bool is_running() const { return state_ == State::kRunning; }
  bool is_finishing() const { return state_ == State::kFinishing; }
  std::uint64_t cycle() const { return cycle_; }              // the next to run
  std::uint64_t first_cycle() const { return first_cycle_; }  // of the frame that was started last
  std::uint64_t done_cycle() const {
    return done_cycle_;
  }  // the first after the frame that was finished last
  CoreControl& control() { return stepper_.control(); }
  const CoreControl& control() const { return stepper_.control(); }
  // Words written by the frame that was started last.
  std::uint64_t writes() const { return all_writes() - writes_before_; }
  // The watchdog's answer for now; see StallWatchdog.
  std::uint64_t stalled_cycles() { return watchdog_.stalled_cycles(cycle_, control().work()); }
  // Which frame runs, and what its ports wait for.
  std::string waits(bool host_requests) const;

  // frame_cycles of every frame that has ended.
  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }
  // From the next frame on, records when each row of results is complete. take_rows() returns the frames
  // that have ended since its last call; the caller takes them regularly, or they fill memory.
  void record_rows() { stepper_.rows().turn_on(); }
  std::vector<RowProfile> take_rows() { return std::exchange(row_profiles_, {}); }

 private:
  enum class State { kIdle, kRunning, kFinishing };

  FrameLatencies route_ports(const FrameBases& bases);
  void begin(std::uint64_t cycle, const FrameBases& bases);
  std::uint64_t all_writes() const { return control().port_cycles(memory::Port::kResult).granted(); }

  CoreConfig config_;
  std::vector<int> latencies_;  // [bank]: of a read, cycles
  CoreStepper stepper_;
  FastForward fast_forward_;
  StallWatchdog watchdog_;
  State state_ = State::kIdle;
  std::uint64_t cycle_ = 0;
  std::uint64_t first_cycle_ = 0;
  std::uint64_t done_cycle_ = 0;
  std::uint64_t writes_before_ = 0;  // words written before the frame that was started last
  std::vector<std::uint64_t> frame_cycles_;
  std::vector<RowProfile> row_profiles_;  // not yet taken
};

}  // namespace stereotlm::fpga
