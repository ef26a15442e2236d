#include "sw/runs/simulation/camera_simulation.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "platform/assembly/computer.h"

namespace stereotlm::runs {
namespace {

const std::vector<std::uint32_t>* entries_of(const std::optional<kernels::RectificationTable>& table) {
  return table ? &table->entries : nullptr;
}

// If nothing progresses for this simulated time, the simulation has stalled. The time exceeds every regular
// wait: for the next camera frame, and for the bus while the traffic generator holds it.
double stall_timeout_seconds(const platform::BoardConfig& board) {
  constexpr double kRest = 0.1;  // seconds; enough for clocks of 1 MHz
  constexpr double kTurns = 4;
  double turn = 1 / board.cameras.frame_rate_hz;
  if (board.pci.load) turn += board.pci.load->access_us / 1e6 + board.pci.load->burst_words / 1e6;
  return kTurns * turn + kRest;
}

}  // namespace

CameraSimulation::CameraSimulation(const platform::BoardConfig& board, const platform::Tables& tables,
                                   host::FrameSource& pairs, std::uint64_t frames, Binder& binder,
                                   fpga::Fidelity fidelity)
    : Simulation(board, tables, pairs, frames, fidelity),
      fidelity_(fidelity),
      driver_(board, frames, entries_of(tables.left), entries_of(tables.right),
              [this](const driver::DeliveredFrame& frame) { frame_delivered(frame); }),
      stall_timeout_seconds_(stall_timeout_seconds(board)) {
  const std::uint64_t bytes = driver::host_memory_bytes(board);
  if (fpga::steps_cycles(fidelity)) {
    computer_ = std::make_unique<platform::Computer>("computer", board, bytes, driver_, left_, right_, binder,
                                                     fidelity);
  } else {
    auto loop = std::make_unique<platform::LoopComputer>(board, bytes, left_, right_, fidelity);
    loop_ = loop.get();
    computer_ = std::move(loop);
  }
}

void CameraSimulation::run(const std::function<void()>& between) {
  if (loop_ == nullptr) return Simulation::run(between);
  loop_->run(driver_, [&] {
    if (!finished()) check_progress();
    pause(between);
    return !finished();
  });
  pause(between);
}

const kernels::GrayImage& CameraSimulation::View::frame(std::uint64_t number, std::uint64_t begin_ps) {
  return simulation_.captured_pair(number, begin_ps).*side_;
}

// Both cameras capture the same frames. The camera that begins a frame first loads its pair, and the other
// one uses that pair too.
const host::StereoPair& CameraSimulation::captured_pair(std::uint64_t number, std::uint64_t begin_ps) {
  if (begins_ps_.emplace(number, begin_ps).second) pair_ = &load_pair(number);
  return *pair_;
}

void CameraSimulation::record_timeline() {
  computer_->record(timeline_.emplace(board()));
  driver_.set_observer(*timeline_);
}

platform::TimelineRecords CameraSimulation::take_timeline() {
  if (!timeline_) return {};
  return finished() ? timeline_->finish() : timeline_->take();
}

void CameraSimulation::end_early() {
  driver_.start_no_more();
  set_frames(driver_.frames_started());
}

platform::Statistics CameraSimulation::statistics() const {
  if (deliveries_.empty() || counters_.board.frames != deliveries_.size()) {
    throw std::logic_error(
        fmt::format("statistics of {} frames requested while the core is busy", deliveries_.size()));
  }
  platform::Statistics statistics =
      platform::collect_statistics(board(), tables(), fpga::steps_cycles(fidelity_) ? "cycle" : "fast",
                                   computer_->core().frame_cycles(), counters_, deliveries_);
  if (timeline_) {
    for (std::string& failed : timeline_->failed(statistics)) statistics.failed.push_back(std::move(failed));
  }
  check_conflicts(statistics);
  return statistics;
}

void CameraSimulation::frame_delivered(const driver::DeliveredFrame& frame) {
  const auto begin = begins_ps_.find(frame.camera_frame);
  deliveries_.push_back({begin->second, now_ps()});
  begins_ps_.erase(begins_ps_.begin(), std::next(begin));
  if (timeline_) timeline_->deliver(deliveries_.back());
  if (driver_.frames_started() == frame.frame + 1) {
    counters_ = computer_->counters();
    if (timeline_) timeline_->mark_end(counters_);
  }
  kernels::GrayImage disparity;
  if (fpga::has_pixels(fidelity_)) {
    disparity.width = board().image.width;
    disparity.height = board().image.height;
    const std::ptrdiff_t pixels = std::ptrdiff_t{disparity.width} * disparity.height;
    disparity.pixels.assign(frame.disparity, frame.disparity + pixels);
  }
  add_result({frame.camera_frame, std::move(disparity)});
}

void CameraSimulation::check_progress() {
  const auto has_progressed = [this] {
    const std::uint64_t work = computer_->work_done();
    return std::exchange(last_work_, work) != work;
  };
  const double idle = static_cast<double>(now_ps() - last_work_at_ps_) / 1e12;
  bool progressed = has_progressed();
  if (!progressed && idle >= stall_timeout_seconds_) {
    computer_->catch_up();
    progressed = has_progressed();
  }
  if (progressed) last_work_at_ps_ = now_ps();
  if (progressed || idle < stall_timeout_seconds_) return;
  throw std::runtime_error(
      fmt::format("no progress for {:.3f} s of simulated time; delivered: {} of {} frames; the driver waits "
                  "for: {}; {}",
                  idle, frames_done(), frames(), driver_.under_way(), computer_->core().waits()));
}

}  // namespace stereotlm::runs
