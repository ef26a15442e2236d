#pragma once

#include <cstdint>
#include <systemc>

#include "models/binder.h"
#include "models/capture/camera_control.h"
#include "models/fpga/core_config.h"
#include "models/host/cpu.h"
#include "models/host/host_bridge.h"
#include "models/host/host_memory.h"
#include "models/host/program.h"
#include "models/interrupt.h"
#include "models/pci/pci_slot_if.h"
#include "platform/assembly/computer_view.h"
#include "platform/config/board_config.h"
#include "platform/loop/computer_loop.h"

namespace stereotlm::platform {

// The computer of computer.h at fidelity fast or timing. Only the processor with its bridge and its memory
// are modules. All other blocks are stepped by ComputerLoop, which runs ahead of the kernel up to the next
// time at which the program sees something: the end of a register access, or an interrupt.
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

  host::HostMemory host_memory;
  host::HostBridge host_bridge;
  host::Cpu cpu;

  std::uint64_t now_ps() const override { return loop_.now_ps(); }

 private:
  ComputerControls controls() override { return loop_.controls(); }
  BoardCounters board_counters() override { return loop_.board().counters(now_ps()); }
  void catch_up() override { loop_.board().catch_up(loop_.now_ps()); }
  void run();
  bool is_asserted() const override { return loop_.interrupt(); }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }

  // The slot of the processor's bridge, in which this module stands between the bus and the bridge.
  void request(pci::PciMasterIf& master, std::uint64_t from_ps) override;
  pci::BurstResult transferred(std::uint64_t now_ps) const override {
    return loop_.pci_bus().slot(kHost).transferred(now_ps);
  }
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

}  // namespace stereotlm::platform
