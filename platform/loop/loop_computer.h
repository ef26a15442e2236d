#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "models/capture/camera_control.h"
#include "models/fpga/core_config.h"
#include "models/host/program.h"
#include "models/memory/ram.h"
#include "models/pci/pci_slot.h"
#include "platform/assembly/computer_view.h"
#include "platform/config/board_config.h"
#include "platform/loop/computer_loop.h"

namespace stereotlm::platform {

// The computer of computer.h at fidelity fast or timing, without modules and without the SystemC kernel: the
// accesses and the waits of the program step ComputerLoop. A process can run any number of them.
class LoopComputer : public ComputerView, private host::HostBus, private pci::PciMasterIf {
 public:
  // `left` and `right` outlive the computer. Throws std::invalid_argument if the board has problems, or
  // `host_memory_bytes` is out of range.
  LoopComputer(const BoardConfig& config, std::uint64_t host_memory_bytes, capture::CameraSource& left,
               capture::CameraSource& right, fpga::Fidelity fidelity);

  // Runs the program from beginning to end. To be called once. `go_on` is called every 10 ms of simulated
  // time; the run ends early if it returns false. Throws what the program, a camera source or `go_on` throws.
  void run(host::Program& program, const std::function<bool()>& go_on);

  std::uint64_t now_ps() const override { return loop_.now_ps(); }
  void catch_up() override { loop_.board().catch_up(loop_.now_ps()); }

 private:
  ComputerControls controls() override { return loop_.controls(); }
  BoardCounters board_counters() override { return loop_.board().counters(now_ps()); }

  std::uint32_t read(std::uint64_t address) override { return access(false, address, 0); }
  void write(std::uint64_t address, std::uint32_t value) override { access(true, address, value); }
  void wait_for_interrupt() override;
  std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) override;

  pci::PciBurst begin_burst(std::uint64_t /*address_clock_ps*/) override { return burst_; }
  void end_burst(const pci::BurstResult& result) override;

  std::uint32_t access(bool write, std::uint64_t address, std::uint32_t value);
  void step();

  memory::Ram host_memory_;
  ComputerLoop loop_;
  std::function<bool()> go_on_;
  std::uint64_t next_ps_ = 0;        // when it is called next
  std::vector<std::uint32_t> word_;  // of the access
  pci::PciBurst burst_;
  pci::BurstResult result_;
  bool burst_has_ended_ = false;
  bool accessed_ = true;  // a register was accessed since wait_for_interrupt() returned
};

}  // namespace stereotlm::platform
