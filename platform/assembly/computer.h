#pragma once

#include <cstdint>
#include <memory>
#include <systemc>

#include "models/binder.h"
#include "models/capture/camera.h"
#include "models/capture/capture_board.h"
#include "models/host/cpu.h"
#include "models/host/host_bridge.h"
#include "models/host/host_memory.h"
#include "models/host/program.h"
#include "models/kernel_time.h"
#include "models/pci/pci_bridge.h"
#include "models/pci/pci_bus.h"
#include "models/pci/traffic_generator.h"
#include "platform/assembly/board.h"
#include "platform/assembly/computer_view.h"
#include "platform/config/board_config.h"
#include "platform/config/device_map.h"

namespace stereotlm::platform {

// The whole computer (paper figure 4; `--source camera`): two cameras, two capture boards, the FPGA board
// behind its PCI bridge, host memory, and the processor that runs `program`. The board key `pci.load` adds a
// traffic generator. DeviceMap has the addresses of the devices. The core is at Fidelity::kCycle;
// LoopComputer is the computer at the others.
class Computer : public sc_core::sc_module, public ComputerView {
 public:
  // `program`, `left` and `right` outlive the computer. `fidelity`: one that steps cycles. Throws
  // std::invalid_argument if the board has problems, or `host_memory_bytes` is out of range.
  Computer(const sc_core::sc_module_name& name, const BoardConfig& config, std::uint64_t host_memory_bytes,
           host::Program& program, capture::CameraSource& left, capture::CameraSource& right, Binder& binder,
           fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  Board board;                          // the FPGA board
  pci::PciBus pci_bus;                  // with the slots of PciMaster and the windows of PciTargetWindow
  pci::PciBridge bridge;                // from the PCI bus to the FPGA board
  host::HostMemory host_memory;         // at DeviceMap::host_memory
  host::HostBridge host_bridge;         // from the processor to the PCI bus
  host::Cpu cpu;                        // runs the program
  capture::Camera left_camera;          // of the left side
  capture::Camera right_camera;         // of the right side
  capture::CaptureBoard left_capture;   // capture board of the left camera
  capture::CaptureBoard right_capture;  // capture board of the right camera
  // Null on a board without `pci.load`. Such a bus has no master kTrafficGenerator.
  std::unique_ptr<pci::TrafficGenerator> traffic_generator;

 private:
  ComputerControls controls() override;
  std::uint64_t now_ps() const override { return kernel_time::now_ps(); }
  BoardCounters board_counters() override { return counters_of(board, now_ps()); }
  void catch_up() override { board.core.catch_up(); }
  void bind_pci(Binder& binder);
  void bind_capture();

  sc_core::sc_signal<bool> done_{"done"};
};

}  // namespace stereotlm::platform
