#include "sw/runs/simulation/simulation.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <systemc>
#include <utility>

#include "models/clock.h"
#include "models/kernel_time.h"
#include "platform/assembly/preloaded_system.h"
#include "platform/figures/collect.h"
#include "platform/loop/core_loop.h"
#include "sw/runs/simulation/camera_simulation.h"

namespace stereotlm::runs {
namespace {

// FPGA cycles of the kernel between two calls of `between`. They take some ms of wall time; at fidelity fast,
// the pixels of a frame that begins in these cycles take additional time.
constexpr double kSliceCycles = 40'000;
constexpr double kFastSliceCycles = 2'000'000;

class PreloadedSimulation : public Simulation, private host::FrameSource, private host::FrameSink {
 public:
  PreloadedSimulation(const platform::BoardConfig& board, const platform::Tables& tables,
                      host::FrameSource& pairs, const RunMode& mode, Binder& binder)
      : Simulation(board, tables, pairs, mode.frames, mode.fidelity),
        system_("system", board, tables, mode.frames, *this, *this, binder, mode.fidelity),
        counters_(platform::counters_of(system_.board)) {}

  fpga::FrameRun& core() override { return system_.board.core.frames(); }

  void end_early() override {
    if (recorder() == nullptr) {
      set_frames(frames_done());
      return;
    }
    const std::uint64_t begun = recorder()->frames_begun();
    set_frames(begun);
    recorder()->record_only(begun);
  }

  platform::Statistics statistics() const override {
    platform::Statistics statistics =
        platform::collect_statistics(board(), tables(), system_.board, counters_);
    check_conflicts(statistics);
    return statistics;
  }

 private:
  const host::StereoPair& pair(std::uint64_t frame) override { return load_pair(frame); }
  // Saves the counters at the end of each frame, because the counters of an interrupted run must not include
  // a part of the running frame.
  void take(std::uint64_t frame, const kernels::GrayImage& disparity) override {
    counters_ = platform::counters_of(system_.board);
    add_result({frame, disparity});
  }
  // Lets a frame that is fast-forwarded pass with the time, so that `between` is called within it.
  void check_progress() override { system_.board.core.catch_up(); }

  platform::PreloadedSystem system_;
  platform::BoardCounters counters_;  // counters at the end of the last finished frame
};

// The board alone without pixels.
class CoreSimulation : public Simulation {
 public:
  CoreSimulation(const platform::BoardConfig& board, const platform::Tables& tables, host::FrameSource& pairs,
                 std::uint64_t frames)
      : Simulation(board, tables, pairs, frames, fpga::Fidelity::kTiming), loop_(board, tables) {}

  void run(const std::function<void()>& between) override {
    while (!finished()) {
      loop_.run_frame();
      add_result({frames_done(), {}});
      pause(between);
    }
  }
  void end_early() override { set_frames(frames_done()); }
  fpga::FrameRun& core() override { return loop_.frames(); }

  platform::Statistics statistics() const override {
    platform::Statistics statistics = statistics_of(board(), loop_.counts());
    check_conflicts(statistics);
    return statistics;
  }

 private:
  std::uint64_t now_ps() const override {
    return Clock(board().fpga.clock_mhz).edge_ps(loop_.frames().done_cycle());
  }

  platform::CoreLoop loop_;
};

}  // namespace

Simulation::Simulation(const platform::BoardConfig& board, const platform::Tables& tables,
                       host::FrameSource& pairs, std::uint64_t frames, fpga::Fidelity fidelity)
    : board_(board),
      tables_(tables),
      pairs_(pairs),
      slice_cycles_(fpga::steps_cycles(fidelity) ? kSliceCycles : kFastSliceCycles),
      frames_(frames) {}

std::uint64_t Simulation::now_ps() const { return kernel_time::now_ps(); }

void Simulation::run(const std::function<void()>& between) {
  while (!finished()) {
    try {
      sc_core::sc_start(slice_cycles_ / board_.fpga.clock_mhz, sc_core::SC_US);
    } catch (const sc_core::sc_report&) {
      if (failure_) std::rethrow_exception(failure_);  // SystemC has replaced it by a report
      throw;
    }
    if (!finished() && !sc_core::sc_pending_activity()) {
      throw std::runtime_error(
          fmt::format("the simulation has ended after {} frames: no event is left that could finish the next",
                      frames_done()));
    }
    if (!finished()) check_progress();
    pause(between);
  }
}

void Simulation::pause(const std::function<void()>& between) {
  if (!new_.empty()) last_ = new_.back();
  between();
  new_.clear();
}

void Simulation::record_conflicts(std::uint64_t frames) {
  recorded_frames_ = frames;
  conflicts_.emplace(board_).recorder().record_only(frames);
  core().record(conflicts_->recorder());
}

void Simulation::trace(const fpga::CycleWindow& window, fpga::CycleObserver& cycles,
                       platform::BusObserver& buses) {
  cycle_observer_ = &cycles;
  bus_observer_ = &buses;
  cycles_.emplace(platform::core_config(board_), conflicts_->recorder(), window,
                  static_cast<fpga::CycleObserver&>(*this));
  if (tables_.left) cycles_->set_entries(fpga::Side::kLeft, tables_.left->entries.data());
  if (tables_.right) cycles_->set_entries(fpga::Side::kRight, tables_.right->entries.data());
  core().record(*cycles_);
  trace_buses(buses_.emplace(board_, window, static_cast<platform::BusObserver&>(*this)));
}

std::vector<fpga::FrameConflicts> Simulation::take_conflicts() {
  return conflicts_ ? conflicts_->take_frames() : std::vector<fpga::FrameConflicts>();
}

void Simulation::check_conflicts(platform::Statistics& statistics) const {
  if (!conflicts_ || statistics.frames > recorded_frames_) return;
  for (std::string& failed : conflicts_->failed(statistics)) statistics.failed.push_back(std::move(failed));
}

std::uint64_t Simulation::cycles() const {
  return static_cast<std::uint64_t>(
      std::llround(static_cast<double>(now_ps()) / 1e12 * board_.fpga.clock_mhz * 1e6));
}

const host::StereoPair& Simulation::load_pair(std::uint64_t number) {
  try {
    return pairs_.pair(number);
  } catch (...) {
    failure_ = std::current_exception();
    throw;
  }
}

void Simulation::add_result(Result result) {
  ++frames_done_;
  result.time_ps = now_ps();
  cycles_of_done_ = cycles();
  if (cycles_) {
    cycles_->hand_out(Clock(board_.fpga.clock_mhz).edge_at_or_after(result.time_ps));
    buses_->hand_out(result.time_ps);
  }
  new_.push_back(std::move(result));
  // Nothing after the last frame matters.
  if (finished() && sc_core::sc_is_running()) sc_core::sc_pause();
}

std::unique_ptr<Simulation> make_simulation(const platform::BoardConfig& board,
                                            const platform::Tables& tables, host::FrameSource& pairs,
                                            const RunMode& mode, Binder& binder) {
  std::unique_ptr<Simulation> simulation;
  if (mode.camera) {
    auto computer =
        std::make_unique<CameraSimulation>(board, tables, pairs, mode.frames, binder, mode.fidelity);
    if (mode.recorded_frames > 0) computer->record_timeline();
    simulation = std::move(computer);
  } else if (mode.fidelity == fpga::Fidelity::kTiming) {
    simulation = std::make_unique<CoreSimulation>(board, tables, pairs, mode.frames);
  } else {
    simulation = std::make_unique<PreloadedSimulation>(board, tables, pairs, mode, binder);
  }
  if (mode.recorded_frames > 0) simulation->record_conflicts(mode.recorded_frames);
  return simulation;
}

}  // namespace stereotlm::runs
