#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/fpga/fast/fast_forward.h"
#include "models/fpga/record/conflict_recorder.h"
#include "models/fpga/record/cycle_recorder.h"
#include "models/fpga/record/row_recorder.h"

namespace stereotlm::fpga {

// The times of a frame of the core.
struct FrameTimes {
  std::uint64_t strobe_ps = 0;    // end of the start strobe
  std::uint64_t first_cycle = 0;  // the first cycle of the frame
  std::uint64_t end_cycle = 0;    // the first cycle after its last write
  std::uint64_t done_cycle = 0;   // the first cycle after the frame; `done` rises as it begins
  std::uint64_t words = 0;        // words written
};

// Receives the frames of a core, for recordings. Plain C++.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  virtual void frame_begun(std::uint64_t strobe_ps) = 0;
  virtual void frame_ended(const FrameTimes& times) = 0;
};

// What frames that work directly on memory do there, over all frames. Their data moves through no stage, so
// no stage counts it.
struct DirectCounts {
  std::vector<std::uint64_t> accesses;   // [bank]
  std::array<std::uint64_t, 2> slots{};  // [side]: issued to the lane
  std::uint64_t packed_words = 0;
  std::uint64_t written_words = 0;
};

// Runs the frames of a core one after another, in cycles of its clock: routes the ports to the banks, runs
// the cycles of a frame, and watches its progress. Plain C++, used by StereoCore and by platform::CoreLoop.
//
// A frame runs up to its last write. Then it is finishing, and ends pipeline_latency_cycles later.
class FrameRun {
 public:
  // `arbitration` outlives this object. Throws std::invalid_argument if the configuration has problems.
  FrameRun(const CoreConfig& config, const std::vector<memory::SsramBankConfig>& banks,
           memory::Arbitration& arbitration, std::uint64_t stall_timeout_cycles);

  // Adds an observer, which outlives this object. The caller then calls strobe() for each frame.
  void observe(FrameObserver& observer) { observers_.push_back(&observer); }
  // To be called after a frame is started.
  void strobe(std::uint64_t time_ps) {
    strobe_ps_ = time_ps;
    for (FrameObserver* const observer : observers_) observer->frame_begun(time_ps);
  }

  // Whether the banks of all buffers exist.
  bool has_banks(const FrameBases& bases) const;
  int read_latency_cycles(std::size_t bank) const { return latencies_[bank]; }

  // Starts a frame in `cycle`, or in cycle() if that is later. The banks of the bases must exist. The caller
  // calls step() for each cycle.
  void start_stepped(std::uint64_t cycle, const FrameBases& bases);
  // Starts a frame that works directly on memory. The caller calls run_ahead().
  // `patterns`: the accesses of the slots; they must outlive the frame.
  void start_direct(std::uint64_t cycle, const FrameBases& bases, const AccessPatterns& patterns);

  // Runs cycle() of a stepped frame. The arguments are those of CoreStepper::step().
  template <class Move, class Entry>
  memory::PortMask step(bool host_requests, const Move& move, const Entry& entry) {
    return core_.step(cycle_++, host_requests, move, entry);
  }
  // Runs the cycles of a direct frame up to `end`, `end` not included, or until the frame is done.
  void run_ahead(std::uint64_t end) { cycle_ = core_.run_ahead(cycle_, end); }
  // As run_ahead(), but steps no cycle: it stops before `end` where a cycle must be stepped.
  void skip_ahead(std::uint64_t end) { cycle_ = core_.skip_ahead(cycle_, end); }
  // Makes `cycle` the next cycle to run. To be called only while no frame runs.
  void set_cycle(std::uint64_t cycle) { cycle_ = cycle; }
  // Serves words of the host in a direct frame, see FastForward.
  FastForward::Served serve_host(const FastForward::Route& route, std::uint64_t first, std::size_t words) {
    return core_.serve_host(cycle_, route, first, words);
  }
  // To be called when control().frame_done() becomes true.
  void finish();
  // To be called in done_cycle().
  void end();

  bool is_running() const { return state_ == State::kRunning; }
  bool is_finishing() const { return state_ == State::kFinishing; }
  // The next cycle to run.
  std::uint64_t cycle() const { return cycle_; }
  // The first cycle of the frame that was started last.
  std::uint64_t first_cycle() const { return first_cycle_; }
  // The first cycle after the frame that was finished last.
  std::uint64_t done_cycle() const { return done_cycle_; }
  // After serve_host() and skip_ahead() its state and counts may be those of an earlier cycle, until
  // run_ahead() is called.
  CoreControl& control() { return core_.control(); }
  const CoreControl& control() const { return core_.control(); }
  // A lower bound of the cycle in which the last write of the frame is granted.
  std::uint64_t earliest_last_write() const {
    const Progress& ahead = core_.ahead();
    return control().earliest_last_write(cycle_, {ahead.cycles, ahead.consumed, ahead.words});
  }
  // A number that grows whenever the frame makes progress.
  std::uint64_t work() const { return control().work() + core_.ahead().consumed + core_.ahead().words; }
  // Words written by the frame that was started last.
  std::uint64_t writes() const { return all_writes() - writes_before_; }
  // The finished frames among those of start_direct().
  const DirectCounts& direct_counts() const { return direct_counts_; }
  // See FastForward.
  std::uint64_t skipped_cycles() const { return core_.skipped_cycles(); }
  // To be called regularly while a frame runs. Returns the number of cycles without progress if it has
  // reached stall_timeout_cycles, else 0. Without progress, the matcher does not work and no result is
  // written: one of the core's ports is never granted. After a timeout the count begins anew.
  std::uint64_t stalled_cycles();
  // Text for messages: the frame that runs, and what its ports wait for.
  std::string waits();

  // The number of cycles of every frame that has ended, from its first cycle to its end (`frame_cycles` in
  // results).
  const std::vector<std::uint64_t>& frame_cycles() const { return frame_cycles_; }
  // From the next frame on, records when each row of results is complete. take_rows() returns the rows of the
  // frames that have ended since its last call. It must be called regularly, because the rows fill memory.
  void record_rows() { core_.rows().turn_on(); }
  std::vector<RowProfile> take_rows() { return std::exchange(row_profiles_, {}); }

  // Sets the source of the host port's next word. To be called once.
  void set_host(NextHostWord host) { host_ = std::move(host); }
  // Records all frames from the next one on. `conflicts` outlives this object.
  void record(ConflictRecorder& conflicts) { conflicts_ = &conflicts; }
  ConflictRecorder* conflicts() { return conflicts_; }
  // Records the cycles of a window, of all frames from the next one on. record(ConflictRecorder&) must have
  // been called. `cycles` outlives this object.
  void record(CycleRecorder& cycles) {
    cycles_ = &cycles;
    cycles.set_host(host_);
  }
  CycleRecorder* cycles() { return cycles_; }

 private:
  enum class State { kIdle, kRunning, kFinishing };

  FrameLatencies route_ports();
  void begin(std::uint64_t cycle, const FrameBases& bases);
  void count_direct();
  std::uint64_t all_writes() const { return control().port_cycles(control().ports().result()).granted(); }

  CoreConfig config_;
  Placements placements_;       // of the frame that was started last
  std::vector<int> latencies_;  // [bank]: read latency, cycles
  FastForward core_;
  std::uint64_t stall_timeout_cycles_;
  std::uint64_t work_ = 0;        // work() in the last call of stalled_cycles()
  std::uint64_t work_cycle_ = 0;  // cycle of the last call that found progress, or of the last timeout
  State state_ = State::kIdle;
  std::uint64_t cycle_ = 0;
  std::uint64_t first_cycle_ = 0;
  std::uint64_t done_cycle_ = 0;
  std::uint64_t strobe_ps_ = 0;
  const AccessPatterns* patterns_ = nullptr;  // of the running frame; null if its stages read the tables
  DirectCounts direct_counts_;
  std::vector<FrameObserver*> observers_;
  NextHostWord host_;  // empty: nothing uses the host port
  ConflictRecorder* conflicts_ = nullptr;
  CycleRecorder* cycles_ = nullptr;
  std::uint64_t writes_before_ = 0;  // words written before the frame that was started last
  std::vector<std::uint64_t> frame_cycles_;
  std::vector<RowProfile> row_profiles_;  // not yet taken
};

}  // namespace stereotlm::fpga
