#pragma once

#include <array>
#include <cstdint>

#include "models/capture/camera_control.h"
#include "models/capture/capture_control.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/local_bus_control.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/figures/collect.h"
#include "platform/records/bus_trace.h"
#include "platform/records/timeline.h"

namespace stereotlm::platform {

// The controls of a computer's blocks: Computer has them in its modules, LoopComputer in its loop.
struct ComputerControls {
  pci::PciBusControl& pci_bus;                           // with its masters and targets
  pci::BridgeControl& bridge;                            // with its DMA channels
  fpga::LocalBusControl& local_bus;                      // at the FPGA
  fpga::FrameRun& core;                                  // its frames
  std::array<capture::CaptureControl*, 2> captures;      // left, right
  std::array<const capture::CameraControl*, 2> cameras;  // the left one, then the right one

  // `board`: the counters of the board at `now_ps`, up to which the controls have been stepped.
  ComputerCounters counters(BoardCounters board, std::uint64_t now_ps) const;
};

// What Computer and LoopComputer show of a run.
class ComputerView {
 public:
  virtual ~ComputerView() = default;

  fpga::FrameRun& core() { return controls().core; }  // the frames, to observe and to record them
  // To be called while the core runs no frame.
  ComputerCounters counters() { return controls().counters(board_counters(), now_ps()); }
  virtual std::uint64_t now_ps() const = 0;  // up to which the controls have been stepped
  // Advances a running frame to the present.
  virtual void catch_up() = 0;
  // A measure of progress towards a result. It may be that of an earlier time, unless catch_up() has just
  // been called.
  std::uint64_t work_done();
  // Hands everything that happens to `timeline`, which outlives the computer. To be called at time 0.
  void record(Timeline& timeline);
  // Hands what the buses and the queues do to `trace`, which outlives the computer. To be called at time 0.
  void trace_buses(BusTrace& trace);

 private:
  virtual ComputerControls controls() = 0;
  virtual BoardCounters board_counters() = 0;
};

}  // namespace stereotlm::platform
