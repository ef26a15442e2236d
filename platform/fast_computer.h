#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "models/binder.h"
#include "models/capture/camera_control.h"
#include "models/fpga/fidelity.h"
#include "models/host/cpu.h"
#include "models/host/host_bridge.h"
#include "models/host/host_memory.h"
#include "models/host/program.h"
#include "models/interrupt.h"
#include "models/pci/pci_slot_if.h"
#include "platform/computer_loop.h"
#include "platform/computer_view.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The computer of computer.h at fidelity fast or timing. Only the processor with its bridge and its memory are
// modules. All other blocks are stepped by ComputerLoop, which runs ahead of the kernel up to the next time at
// which the program sees something: the end of a register access, or an interrupt.
class FastComputer : public sc_core::sc_module,
                     public ComputerView,
                     private InterruptIf,
                     private pci::PciSlotIf,
                     private pci::PciMasterIf {
 public:
  // `program`, `left` and `right` outlive the computer. Throws std::invalid_argument if the board has
  // problems, or `host_memory_bytes` is out of range. An exception of the loop or of a camera source is
  // reported by the kernel.
  FastComputer(const sc_core::sc_module_name& name, const BoardConfig& config,
               std::uint64_t host_memory_bytes, host::Program& program, capture::CameraSource& left,
               capture::CameraSource& right, Binder& binder, fpga::Fidelity fidelity);

  ComputerCounters counters() const override { return loop_.counters(); }
  const fpga::FrameRun& core_frames() const override { return loop_.board().frames(); }
  std::uint64_t work_done() override { return loop_.work_done(); }
  std::string waits() override { return loop_.board().waits(); }
  void record(Timeline& timeline) override { loop_.record(timeline); }
  void trace_buses(BusTrace& trace) override { loop_.trace_buses(trace); }
  void record(fpga::ConflictRecorder& conflicts) override { loop_.board().record(conflicts); }
  void record(fpga::CycleRecorder& cycles) override { loop_.board().record(cycles); }
  void record_rows() override { loop_.board().record_rows(); }
  std::vector<fpga::RowProfile> take_rows() override { return loop_.board().take_rows(); }

  host::HostMemory host_memory;
  host::HostBridge host_bridge;
  host::Cpu cpu;

 private:
  void run();
  bool is_asserted() const override { return loop_.interrupt(); }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

  // The slot of the processor's bridge, in which this module stands between the bus and the bridge.
  void request(pci::PciMasterIf& master, std::uint64_t from_ps) override;
  pci::BurstResult transferred(std::uint64_t now_ps) const override;
  const Clock& clock() const override { return loop_.pci_bus().clock(); }
  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    return master_->begin_burst(address_clock_ps);
  }
  void end_burst(const pci::BurstResult& result) override;

  ComputerLoop loop_;
  pci::PciMasterIf* master_ = nullptr;
  bool burst_has_ended_ = false;
  pci::BurstResult result_;
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
};

// Computer at Fidelity::kCycle, FastComputer at the others.
std::unique_ptr<ComputerView> make_computer(const sc_core::sc_module_name& name, const BoardConfig& config,
                                            std::uint64_t host_memory_bytes, host::Program& program,
                                            capture::CameraSource& left, capture::CameraSource& right,
                                            Binder& binder, fpga::Fidelity fidelity);

}  // namespace stereotlm::platform
