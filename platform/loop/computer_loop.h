#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/capture/camera_control.h"
#include "models/capture/capture_control.h"
#include "models/fpga/core_config.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "models/pci/traffic_control.h"
#include "models/time_ps.h"
#include "platform/assembly/computer_view.h"
#include "platform/config/board_config.h"
#include "platform/config/computer_parts.h"
#include "platform/loop/fast_board.h"

namespace stereotlm::platform {

// The computer without its processor at fidelity fast or timing: the controls of all blocks, bound directly
// and stepped in the order of their events (contract section 3, "To the clock"), without the SystemC kernel.
// The master kHost of the PCI bus is free for the processor's bridge.
class ComputerLoop : private pci::BridgeControl::Host {
 public:
  // `host_memory` has `host_memory_bytes` bytes. It, `left` and `right` outlive the loop. Throws
  // std::invalid_argument if the board has problems.
  ComputerLoop(const BoardConfig& config, unsigned char* host_memory, std::uint64_t host_memory_bytes,
               capture::CameraSource& left, capture::CameraSource& right, fpga::Fidelity fidelity);
  ComputerLoop(const ComputerLoop&) = delete;
  ComputerLoop& operator=(const ComputerLoop&) = delete;

  // Times are below 2^60 - 1 ps, which are 13 days.
  static constexpr std::uint64_t kEndOfTime = (std::uint64_t{1} << 60U) - 1;
  // Steps the blocks until the interrupt rises, notice() is called, or `end_ps` is reached. On an interrupt
  // or notice() it stops before the decisions of that time, because the processor acts before them. At
  // `end_ps` it stops after the decisions. Throws std::invalid_argument if end_ps >= kEndOfTime.
  void run(std::uint64_t end_ps);
  // The time up to which the blocks have been stepped.
  std::uint64_t now_ps() const { return now_ps_; }
  // To be called in a step that the processor is to see.
  void notice() { noticed_ = true; }
  // The shared INTA#.
  bool interrupt() const {
    return bridge_.interrupts() || captures_[0].interrupt() || captures_[1].interrupt();
  }

  pci::PciSlot& host_slot() { return pci_bus_.slot(kHost); }
  FastBoard& board() { return board_; }
  ComputerControls controls();
  const pci::PciBusControl& pci_bus() const { return pci_bus_; }

 private:
  // A window of the PCI bus, whose accesses the loop serves. The controls serve those to registers.
  class Window : public pci::PciTarget {
   public:
    Window(ComputerLoop& loop, std::size_t window) : loop_(loop), window_(window) {}
    std::size_t writable_words(std::uint64_t now_ps, std::uint64_t address, std::size_t words) override {
      return window_ == kBridgeSlave ? loop_.bridge_.postable_words(now_ps, address, words) : words;
    }
    pci::PciAnswer access(std::uint64_t now_ps, const pci::PciAccess& access, std::uint64_t at_ps) override {
      return loop_.access(window_, now_ps, access, at_ps);
    }

   private:
    ComputerLoop& loop_;
    std::size_t window_;
  };

  // The events of one time, in their order (contract section 3, "To the clock").
  enum Kind : std::uint64_t {
    kLocalBusEnds,
    kPciSteps,
    kFrameEnds,
    kRegister,
    kLeftCamera,
    kRightCamera,
    kSlaveRead,
    kLeftPixels,
    kRightPixels,
    kLocalBusChooses,
    kPciDecides,  // the first decision
    kCoreDecides,
    kLeftDecides,
    kRightDecides,
  };

  pci::PciAnswer access(std::size_t window, std::uint64_t now_ps, const pci::PciAccess& access,
                        std::uint64_t at_ps);
  // A number that orders events by time, then by kind. kNever is behind all times.
  static constexpr unsigned kKindBits = 4;
  static_assert(kEndOfTime == kNever >> kKindBits);
  static constexpr std::uint64_t event(std::uint64_t time_ps, Kind kind) {
    return time_ps << kKindBits | kind;
  }
  std::uint64_t next_event() const;
  void step(Kind kind);
  void slave_read_ended(std::uint64_t now_ps, bool ok) override { pci_bus_.answer(now_ps, {now_ps, ok}); }
  void interrupt_changed(std::uint64_t /*now_ps*/) override {}

  pci::PciBusControl pci_bus_;
  FastBoard board_;
  pci::BridgeControl bridge_;
  std::array<capture::CaptureControl, 2> captures_;  // left, right
  std::array<capture::CameraControl, 2> cameras_;
  std::optional<pci::TrafficControl> traffic_;
  Window host_memory_window_{*this, kHostMemory};
  Window bridge_slave_{*this, kBridgeSlave};
  Window traffic_device_{*this, kTrafficDevice};
  unsigned char* host_memory_;
  std::uint64_t traffic_access_ps_ = 0;  // for which the device of the traffic generator makes the bus wait
  std::uint64_t now_ps_ = 0;
  pci::PciAccess bridge_read_;
  std::uint64_t bridge_read_ps_ = kNever;  // the end of the address clock of a read: it reaches the bridge
  bool interrupt_ = false;                 // level after the last step
  bool noticed_ = false;
};

}  // namespace stereotlm::platform
