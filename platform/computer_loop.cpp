#include "platform/computer_loop.h"

#include <algorithm>
#include <cstring>

#include "models/capture/capture_register_file.h"
#include "models/capture/capture_registers.h"
#include "models/pci/bridge_registers.h"
#include "platform/computer_parts.h"

namespace stereotlm::platform {
namespace {

// The order of the events of one time (contract section 3, "To the clock").
enum Rank : std::uint64_t { kLocalBusEnds, kEffects, kPixels, kLocalBusChooses, kDecisions };
constexpr unsigned kRankBits = 3;

// A number that orders events by time, then by rank. Times are below 2^61 ps, which are 26 days.
constexpr std::uint64_t event(std::uint64_t time_ps, Rank rank) { return time_ps << kRankBits | rank; }
constexpr std::uint64_t kNoEvent = UINT64_MAX;
constexpr std::uint64_t event_or_none(std::uint64_t time_ps, Rank rank) {
  return time_ps == kNever ? kNoEvent : event(time_ps, rank);
}

bool is_one_word(const pci::PciAccess& access, std::uint64_t end) {
  return access.count == 1 && access.address < end;
}

}  // namespace

ComputerLoop::ComputerLoop(const BoardConfig& config, unsigned char* host_memory,
                           std::uint64_t host_memory_bytes, capture::CameraSource& left,
                           capture::CameraSource& right, fpga::Fidelity fidelity)
    : pci_bus_(pci_config(config, host_memory_bytes)),
      board_(config, fidelity, *this),
      bridge_(bridge_config(config), pci_bus_.slot(kBridge), board_.local_bus(), *this),
      captures_{capture::CaptureControl(capture_config(config)),
                capture::CaptureControl(capture_config(config))},
      cameras_{capture::CameraControl(camera_config(config), left, captures_[0]),
               capture::CameraControl(camera_config(config), right, captures_[1])},
      host_memory_(host_memory),
      capture_registers_{CaptureRegisterTarget(captures_[0]), CaptureRegisterTarget(captures_[1])},
      traffic_device_(config.pci.load ? traffic_config(config)->access_ps : 0) {
  bind();
  if (const auto traffic = traffic_config(config)) {
    pci_bus_.bind(kTrafficDevice, traffic_device_);
    traffic_.emplace(*traffic).start(pci_bus_.slot(kTrafficGenerator));
  }
}

void ComputerLoop::bind() {
  board_.local_bus().bind(bridge_.local_bus_master());
  pci_bus_.bind(kHostMemory, host_memory_);
  pci_bus_.bind(kBridgeSlave, bridge_slave_);
  pci_bus_.bind(kBridgeRegisters, bridge_registers_);
  pci_bus_.bind(kLeftRegisters, capture_registers_[0]);
  pci_bus_.bind(kRightRegisters, capture_registers_[1]);
  captures_[0].bind(pci_bus_.slot(kLeftCapture), cameras_[0]);
  captures_[1].bind(pci_bus_.slot(kRightCapture), cameras_[1]);
  captures_[0].bind_partner(captures_[1]);
  captures_[1].bind_partner(captures_[0]);
  // The trigger of the left capture board starts both cameras.
  for (capture::CameraControl& camera : cameras_) captures_[0].bind_triggered(camera);
}

pci::PciSlot& ComputerLoop::host_slot() { return pci_bus_.slot(kHost); }
const pci::PciSlot& ComputerLoop::host_slot() const { return pci_bus_.slot(kHost); }

void ComputerLoop::run(std::uint64_t end_ps) {
  noticed_ = false;
  for (;;) {
    const std::array<std::uint64_t, 9> events = {
        event_or_none(bridge_.next_ps(), bridge_.ends_next() ? kLocalBusEnds : kLocalBusChooses),
        event_or_none(pci_bus_.next_ps(), pci_bus_.decides_next() ? kDecisions : kEffects),
        event_or_none(board_.next_ps(), board_.ends_frame_next() ? kEffects : kDecisions),
        event_or_none(board_.local_bus().next_ps(), kEffects),
        event_or_none(captures_[0].next_ps(), captures_[0].decides_next() ? kDecisions : kPixels),
        event_or_none(captures_[1].next_ps(), captures_[1].decides_next() ? kDecisions : kPixels),
        event_or_none(cameras_[0].next_ps(), kEffects),
        event_or_none(cameras_[1].next_ps(), kEffects),
        event_or_none(bridge_slave_.next_ps(), kEffects)};
    const auto next = std::min_element(events.begin(), events.end());
    if (noticed_ && *next >= event(now_ps_, kDecisions)) return;
    if (*next > event(end_ps, kDecisions)) {
      now_ps_ = end_ps;
      return;
    }
    now_ps_ = *next >> kRankBits;
    switch (next - events.begin()) {
      case 0:
        bridge_.step(now_ps_);
        break;
      case 1:
        pci_bus_.decides_next() ? pci_bus_.decide(now_ps_) : pci_bus_.step(now_ps_);
        break;
      case 2:
        board_.step(now_ps_);
        break;
      case 3:
        board_.local_bus().step(now_ps_);
        break;
      case 4:
      case 5:
        captures_[static_cast<std::size_t>(next - events.begin() - 4)].step(now_ps_);
        break;
      case 6:
      case 7:
        cameras_[static_cast<std::size_t>(next - events.begin() - 6)].step(now_ps_);
        break;
      default:
        bridge_slave_.step(now_ps_);
    }
    const bool level = interrupt();
    if (level && !interrupt_) noticed_ = true;
    interrupt_ = level;
  }
}

void ComputerLoop::record(Timeline& timeline) {
  for (std::size_t side = 0; side < captures_.size(); ++side)
    captures_[side].observe(timeline.capture_board(side));
  bridge_.observe(timeline.bridge());
  board_.observe(timeline.core());
}

std::uint64_t ComputerLoop::work_done() {
  board_.catch_up(now_ps_);
  return board_.frames().control().work() + words_for_results(pci_bus_.stats(now_ps_));
}

ComputerCounters ComputerLoop::counters() const {
  const fpga::LocalBusControl& local_bus = board_.local_bus();
  const auto camera = [this](std::size_t side) {
    return ComputerCounters::Camera{cameras_[side].stats().frames, captures_[side].undecided(),
                                    captures_[side].stats(now_ps_)};
  };
  return {board_.counters(),
          pci_bus_.stats(now_ps_),
          bridge_.stats(),
          local_bus.stats(now_ps_),
          {bridge_.words_taken().words(), bridge_.words_held().words(), local_bus.words_to_grant().words(),
           local_bus.words_granted().words()},
          {camera(0), camera(1)}};
}

pci::PciAnswer ComputerLoop::HostMemoryTarget::access(std::uint64_t /*now_ps*/, const pci::PciAccess& access,
                                                      std::uint64_t at_ps) {
  unsigned char* const stored = memory_ + access.address;
  if (access.write) {
    std::memcpy(stored, access.words, 4 * access.count);
  } else {
    std::memcpy(access.words, stored, 4 * access.count);
  }
  return {at_ps, true};
}

pci::PciAnswer ComputerLoop::BridgeSlaveTarget::access(std::uint64_t now_ps, const pci::PciAccess& access,
                                                       std::uint64_t at_ps) {
  if (access.write) {
    const auto* const data = reinterpret_cast<const unsigned char*>(access.words);
    return {at_ps, loop_.bridge_.write(now_ps, access.address, data, access.count)};
  }
  read_ = access;
  next_ps_ = at_ps;
  return {kNever, true};
}

void ComputerLoop::BridgeSlaveTarget::step(std::uint64_t now_ps) {
  next_ps_ = kNever;
  loop_.bridge_.read(now_ps, read_.address, reinterpret_cast<unsigned char*>(read_.words), read_.count);
}

pci::PciAnswer ComputerLoop::BridgeRegisterTarget::access(std::uint64_t now_ps, const pci::PciAccess& access,
                                                          std::uint64_t at_ps) {
  if (!is_one_word(access, pci::bridge::kRegisterWindowBytes)) {
    bridge_.count_error();
    return {at_ps, false};
  }
  return {at_ps, access.write ? bridge_.write_register(now_ps, access.address, *access.words)
                              : bridge_.read_register(access.address, *access.words)};
}

pci::PciAnswer ComputerLoop::CaptureRegisterTarget::access(std::uint64_t now_ps, const pci::PciAccess& access,
                                                           std::uint64_t at_ps) {
  if (!is_one_word(access, capture::registers::kEnd) ||
      !capture::CaptureRegisterFile::allows(access.write, access.address)) {
    board_.count_refused_access();
    return {at_ps, false};
  }
  if (access.write) {
    board_.write(now_ps, access.address, *access.words);
  } else {
    *access.words = board_.read(access.address);
  }
  return {at_ps, true};
}

pci::PciAnswer ComputerLoop::TrafficTarget::access(std::uint64_t /*now_ps*/, const pci::PciAccess& access,
                                                   std::uint64_t at_ps) {
  if (access.write) return {at_ps, false};
  std::fill_n(access.words, access.count, 0);
  return {at_ps + access_ps_, true};
}

}  // namespace stereotlm::platform
