#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "models/binder.h"
#include "models/capture/camera.h"
#include "platform/assembly/computer_view.h"
#include "platform/figures/collect.h"
#include "platform/loop/loop_computer.h"
#include "platform/records/bus_trace.h"
#include "platform/records/timeline.h"
#include "sw/driver/stereo_driver.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// `--source camera`: the whole computer with the driver on its processor. Camera frame k shows pair k. A run
// that ends early still finishes and delivers the frames that the core has begun.
class CameraSimulation : public Simulation {
 public:
  // The referenced arguments outlive the simulation. Throws std::exception if the computer cannot be built.
  // `binder` binds its sockets: at fidelity fast and timing it has none, and needs no SystemC kernel. Then a
  // process can run any number of simulations, one after the other.
  CameraSimulation(const platform::BoardConfig& board, const platform::Tables& tables,
                   host::FrameSource& pairs, std::uint64_t frames, Binder& binder,
                   fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  void run(const std::function<void()>& between) override;

  // Records the run from its beginning, for take_timeline(). To be called before run(). statistics() then
  // also checks the identities of the records.
  void record_timeline();
  // See ComputerView. To be called before run().
  void trace_buses(platform::BusTrace& buses) override { computer_->trace_buses(buses); }

  void end_early() override;
  fpga::FrameRun& core() override { return computer_->core(); }
  platform::TimelineRecords take_timeline() override;
  platform::Statistics statistics() const override;
  platform::ComputerView& computer() { return *computer_; }

 private:
  // The scene in front of one camera.
  class View : public capture::CameraSource {
   public:
    View(CameraSimulation& simulation, kernels::GrayImage host::StereoPair::*side)
        : simulation_(simulation), side_(side) {}
    const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) override;

   private:
    CameraSimulation& simulation_;
    kernels::GrayImage host::StereoPair::*side_;
  };

  const host::StereoPair& captured_pair(std::uint64_t number, std::uint64_t begin_ps);
  void frame_delivered(const driver::DeliveredFrame& frame);
  void check_progress() override;
  std::uint64_t now_ps() const override { return computer_->now_ps(); }

  fpga::Fidelity fidelity_;
  View left_{*this, &host::StereoPair::left};
  View right_{*this, &host::StereoPair::right};
  driver::StereoDriver driver_;
  std::unique_ptr<platform::ComputerView> computer_;
  platform::LoopComputer* loop_ = nullptr;  // the computer, if it is one
  const host::StereoPair* pair_ = nullptr;  // pair of the last captured frame
  // Start time of each captured camera frame that is not delivered yet, by its number.
  std::map<std::uint64_t, std::uint64_t> begins_ps_;
  std::vector<platform::Delivery> deliveries_;
  std::optional<platform::Timeline> timeline_;
  platform::ComputerCounters counters_;  // counters at the last delivery at which the core was idle
  double stall_timeout_seconds_;
  std::uint64_t last_work_ = 0;
  std::uint64_t last_work_at_ps_ = 0;
};

}  // namespace stereotlm::runs
