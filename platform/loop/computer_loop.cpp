#include "platform/loop/computer_loop.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace stereotlm::platform {

ComputerLoop::ComputerLoop(const BoardConfig& config, unsigned char* host_memory,
                           std::uint64_t host_memory_bytes, capture::CameraSource& left,
                           capture::CameraSource& right, fpga::Fidelity fidelity)
    : pci_bus_(pci_config(config, host_memory_bytes)),
      board_(config, fidelity, [this](std::uint64_t now_ps) { bridge_.ring(now_ps); }),
      bridge_(bridge_config(config), pci_bus_.slot(kBridge), board_.local_bus(), *this),
      captures_{capture::CaptureControl(capture_config(config)),
                capture::CaptureControl(capture_config(config))},
      cameras_{capture::CameraControl(camera_config(config), left, captures_[0]),
               capture::CameraControl(camera_config(config), right, captures_[1])},
      host_memory_(host_memory) {
  board_.local_bus().bind(bridge_.local_bus_master());
  pci_bus_.bind(kHostMemory, host_memory_window_);
  pci_bus_.bind(kBridgeSlave, bridge_slave_);
  pci_bus_.bind(kBridgeRegisters, bridge_);
  pci_bus_.bind(kLeftRegisters, captures_[0]);
  pci_bus_.bind(kRightRegisters, captures_[1]);
  captures_[0].bind(pci_bus_.slot(kLeftCapture), cameras_[0]);
  captures_[1].bind(pci_bus_.slot(kRightCapture), cameras_[1]);
  captures_[0].bind_partner(captures_[1]);
  captures_[1].bind_partner(captures_[0]);
  // The trigger of the left capture board starts both cameras.
  for (capture::CameraControl& camera : cameras_) captures_[0].bind_triggered(camera);
  if (const auto traffic = traffic_config(config)) {
    pci_bus_.bind(kTrafficDevice, traffic_device_);
    traffic_access_ps_ = traffic->access_ps;
    traffic_.emplace(*traffic).start(pci_bus_.slot(kTrafficGenerator));
  }
}

std::uint64_t ComputerLoop::next_event() const {
  const std::uint64_t of_buses =
      std::min(event(bridge_.next_ps(), bridge_.ends_next() ? kLocalBusEnds : kLocalBusChooses),
               event(pci_bus_.next_ps(), pci_bus_.decides_next() ? kPciDecides : kPciSteps));
  std::uint64_t next =
      std::min(of_buses, event(board_.next_ps(), board_.ends_frame_next() ? kFrameEnds : kCoreDecides));
  // These are seldom next: most calls only compare times.
  const std::uint64_t others_ps = std::min(std::min(std::min(cameras_[0].next_ps(), cameras_[1].next_ps()),
                                                    std::min(captures_[0].next_ps(), captures_[1].next_ps())),
                                           std::min(board_.local_bus().next_ps(), bridge_read_ps_));
  if (event(others_ps, Kind{}) > next) return next;
  const auto consider = [&next](std::uint64_t time_ps, Kind kind) {
    next = std::min(next, event(time_ps, kind));
  };
  consider(board_.local_bus().next_ps(), kRegister);
  consider(cameras_[0].next_ps(), kLeftCamera);
  consider(cameras_[1].next_ps(), kRightCamera);
  consider(bridge_read_ps_, kSlaveRead);
  consider(captures_[0].next_ps(), captures_[0].decides_next() ? kLeftDecides : kLeftPixels);
  consider(captures_[1].next_ps(), captures_[1].decides_next() ? kRightDecides : kRightPixels);
  return next;
}

void ComputerLoop::run(std::uint64_t end_ps) {
  if (end_ps >= kEndOfTime) {
    throw std::invalid_argument("end_ps = " + std::to_string(end_ps) + ": must be below " +
                                std::to_string(kEndOfTime));
  }
  noticed_ = false;
  for (;;) {
    const std::uint64_t next = next_event();
    if (noticed_ && next >= event(now_ps_, kPciDecides)) return;
    if (next >= event(end_ps + 1, Kind{})) {
      now_ps_ = end_ps;
      return;
    }
    now_ps_ = next >> kKindBits;
    const auto kind = static_cast<Kind>(next & ((1U << kKindBits) - 1));
    step(kind);
    const bool level = interrupt();
    if (level && !interrupt_) noticed_ = true;
    interrupt_ = level;
  }
}

void ComputerLoop::step(Kind kind) {
  switch (kind) {
    case kLocalBusEnds:
    case kLocalBusChooses:
      return bridge_.step(now_ps_);
    case kPciSteps:
      return pci_bus_.step(now_ps_);
    case kPciDecides:
      return pci_bus_.decide(now_ps_);
    case kFrameEnds:
    case kCoreDecides:
      return board_.step(now_ps_);
    case kRegister:
      return board_.local_bus().step(now_ps_);
    case kLeftCamera:
    case kRightCamera:
      return cameras_[kind - kLeftCamera].step(now_ps_);
    case kSlaveRead:
      bridge_read_ps_ = kNever;
      return bridge_.read(now_ps_, bridge_read_.address, reinterpret_cast<unsigned char*>(bridge_read_.words),
                          bridge_read_.count);
    case kLeftPixels:
    case kRightPixels:
      return captures_[kind - kLeftPixels].step(now_ps_);
    case kLeftDecides:
    case kRightDecides:
      return captures_[kind - kLeftDecides].step(now_ps_);
  }
}

ComputerControls ComputerLoop::controls() {
  return {pci_bus_,
          bridge_,
          board_.local_bus(),
          board_.frames(),
          {&captures_[0], &captures_[1]},
          {&cameras_[0], &cameras_[1]}};
}

pci::PciAnswer ComputerLoop::access(std::size_t window, std::uint64_t now_ps, const pci::PciAccess& access,
                                    std::uint64_t at_ps) {
  if (window == kBridgeSlave && access.write) {
    const auto* const data = reinterpret_cast<const unsigned char*>(access.words);
    return {at_ps, bridge_.write(now_ps, access.address, data, access.count)};
  }
  if (window == kBridgeSlave) {
    bridge_read_ = access;
    bridge_read_ps_ = at_ps;
    return {kNever, true};
  }
  if (window == kHostMemory) {
    unsigned char* const stored = host_memory_ + access.address;
    const bool write = access.write;
    std::memcpy(write ? static_cast<void*>(stored) : access.words,
                write ? static_cast<const void*>(access.words) : stored, 4 * access.count);
    return {at_ps, true};
  }
  // The device of the traffic generator.
  if (access.write) return {at_ps, false};
  std::fill_n(access.words, access.count, 0);
  return {at_ps + traffic_access_ps_, true};
}

}  // namespace stereotlm::platform
