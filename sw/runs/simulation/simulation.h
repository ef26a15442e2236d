#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/record/core_cycle.h"
#include "models/fpga/record/cycle_recorder.h"
#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"
#include "platform/records/bus_trace.h"
#include "platform/records/conflicts.h"
#include "platform/records/timeline_records.h"

namespace stereotlm {
class Binder;
}

namespace stereotlm::runs {

inline constexpr std::uint64_t kAllFrames = UINT64_MAX;

// The result of a frame.
struct Result {
  std::uint64_t number = 0;  // number of the camera frame; it shows pair `number` modulo the number of pairs
  kernels::GrayImage disparity;
  std::uint64_t time_ps = 0;  // time of its delivery
};

// Simulates a board and its surroundings on the pairs of a source until `frames` results are delivered. Of
// those of the SystemC kernel, one object per process: it elaborates once.
class Simulation : private fpga::CycleObserver, private platform::BusObserver {
 public:
  ~Simulation() override = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Simulates all frames. `between` is called again and again, after some ms of wall time, and at the end; at
  // fidelity fast, the pixels of a whole frame may also lie between two calls. It may call end_early().
  // Throws what `between` throws, sc_core::sc_report if a model reports an error, the exception of the source
  // if it cannot load a pair, and std::runtime_error if the simulation runs out of events or stalls before
  // the last frame is finished.
  virtual void run(const std::function<void()>& between);
  // In `between`: the results since its last call, in order.
  std::vector<Result> take_results() { return std::exchange(new_, {}); }

  // Reduces the run to the frames that are finished or have already changed the counters. The results then
  // equal the results of a complete run with fewer frames.
  virtual void end_early() = 0;

  std::uint64_t frames() const { return frames_; }  // frames of the whole run
  std::uint64_t frames_done() const { return frames_done_; }
  bool finished() const { return frames_done_ == frames_; }
  // FPGA cycles from time 0: cycles() until now, cycles_of_done() until the last result.
  std::uint64_t cycles() const;
  std::uint64_t cycles_of_done() const { return cycles_of_done_; }

  // The frames of the core, which may have ended before their results are delivered.
  virtual fpga::FrameRun& core() = 0;

  // If the run is recorded, the records since the last call; after the last frame, up to the end of the run.
  // To be called in `between`, because they fill memory, and before statistics(). A board alone has none.
  virtual platform::TimelineRecords take_timeline() { return {}; }

  // Records where and when the ports of the core stall, in its first `frames` frames. To be called before
  // run(). A board alone then finishes its running frame when it ends early. If all frames are recorded,
  // statistics() also checks the identities of the records.
  void record_conflicts(std::uint64_t frames = kAllFrames);
  // The frames of the core that have ended since the last call. To be called as take_timeline().
  std::vector<fpga::FrameConflicts> take_conflicts();
  // Null if conflicts are not recorded.
  const fpga::ConflictRecorder* conflicts() const { return conflicts_ ? &conflicts_->recorder() : nullptr; }

  // Reports to the observers what the core does in the window, and what the buses and queues of a computer do
  // in it. To be called after record_conflicts(), before run(). The observers outlive the simulation. An
  // exception of an observer ends the simulation, and run() throws it.
  void trace(const fpga::CycleWindow& window, fpga::CycleObserver& cycles, platform::BusObserver& buses);

  // The figures of the finished frames. May be called only while no frame runs that end_early() would let
  // finish. A whole computer also needs its first result.
  virtual platform::Statistics statistics() const = 0;
  const Result& last() const { return last_; }

 protected:
  // The references outlive the simulation.
  Simulation(const platform::BoardConfig& board, const platform::Tables& tables, host::FrameSource& pairs,
             std::uint64_t frames, fpga::Fidelity fidelity);

  const platform::BoardConfig& board() const { return board_; }
  const platform::Tables& tables() const { return tables_; }
  void set_frames(std::uint64_t frames) { frames_ = frames; }
  virtual std::uint64_t now_ps() const;  // the simulated time
  // Calls `between`.
  void pause(const std::function<void()>& between);
  // Loads a pair. An exception of the source ends the simulation, and run() throws it.
  const host::StereoPair& load_pair(std::uint64_t number);
  void add_result(Result result);
  fpga::ConflictRecorder* recorder() { return conflicts_ ? &conflicts_->recorder() : nullptr; }
  // Adds the identities of what is recorded that do not hold.
  void check_conflicts(platform::Statistics& statistics) const;
  // Hands what the buses do to the trace. A board alone has none.
  virtual void trace_buses(platform::BusTrace& /*buses*/) {}
  // Called again and again. Throws std::runtime_error if the simulation has stalled.
  virtual void check_progress() {}

 private:
  void cycle(const fpga::CoreCycle& cycle) override {
    keep_failure([&] { cycle_observer_->cycle(cycle); });
  }
  void burst(const platform::BusBurst& burst) override {
    keep_failure([&] { bus_observer_->burst(burst); });
  }
  void level(const platform::QueueLevel& level) override {
    keep_failure([&] { bus_observer_->level(level); });
  }
  // Calls `action`. Within a SystemC process, the kernel replaces its exception by a report.
  template <typename Action>
  void keep_failure(const Action& action) {
    try {
      action();
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }

  const platform::BoardConfig& board_;
  const platform::Tables& tables_;
  host::FrameSource& pairs_;
  double slice_cycles_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
  std::uint64_t cycles_of_done_ = 0;
  std::vector<Result> new_;  // results since the last pause()
  Result last_;
  std::optional<platform::Conflicts> conflicts_;
  std::uint64_t recorded_frames_ = kAllFrames;
  std::optional<fpga::CycleRecorder> cycles_;
  std::optional<platform::BusTrace> buses_;
  fpga::CycleObserver* cycle_observer_ = nullptr;
  platform::BusObserver* bus_observer_ = nullptr;
  std::exception_ptr failure_;  // exception of the source or of an observer
};

// The options of a simulation, without board, tables and pictures.
struct RunMode {
  bool camera = true;  // true: the whole computer; false: the board alone (preloaded)
  fpga::Fidelity fidelity = fpga::Fidelity::kFast;
  std::uint64_t frames = 1;
  // The first frames whose conflicts are recorded; 0: nothing is recorded. The time line of the whole
  // computer is recorded to its end.
  std::uint64_t recorded_frames = 0;
};

// Creates a CameraSimulation, or a simulation of the board alone with an ideal host, in which frame f shows
// pair f. A board alone that ends early drops the running frame, but finishes it if conflicts are recorded.
// The arguments, except `mode`, outlive it. Throws std::exception if it cannot be built.
std::unique_ptr<Simulation> make_simulation(const platform::BoardConfig& board,
                                            const platform::Tables& tables, host::FrameSource& pairs,
                                            const RunMode& mode, Binder& binder);

}  // namespace stereotlm::runs
