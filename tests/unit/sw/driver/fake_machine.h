#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/host/program.h"
#include "models/pci/bridge_registers.h"
#include "platform/config/device_map.h"

namespace stereotlm::driver {

// A computer without time and without pixels: what has been under way for longest ends when the program waits
// for an interrupt. The random computers show which buffers the driver uses, and when.
class FakeMachine : public host::HostBus {
 public:
  explicit FakeMachine(std::uint64_t memory_bytes = 1U << 16U) : memory_(memory_bytes) {}

  std::optional<std::uint64_t> failing_capture;    // loses words
  std::optional<std::uint64_t> diverging_capture;  // its sides take different frames
  bool failing_write = false;                      // the board refuses one that was posted
  bool failing_core = false;
  std::optional<unsigned> failing_channel;

  std::uint32_t read(std::uint64_t address) override {
    if (address == map_.bridge_registers + pci::bridge::kInterruptStatus) return interrupts_;
    if (address == core_register(fpga::registers::kStatus))
      return failing_core ? fpga::registers::kStatusError : 0U;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::uint64_t base = side == 0 ? map_.left_capture : map_.right_capture;
      const std::uint64_t frame = captures_[side] - 1;
      if (address == base + capture::registers::kStatus) return capture_status_[side];
      if (address == base + capture::registers::kFrameNumberLow)
        return static_cast<std::uint32_t>(frame) + (side == 1 && diverging_capture == frame ? 1 : 0);
      if (address == base + capture::registers::kFrameNumberHigh) return 0;
    }
    throw host::BusError("read of " + std::to_string(address));
  }

  void write(std::uint64_t address, std::uint32_t value) override {
    if (address >= map_.left_capture) {
      write_capture(address >= map_.right_capture ? 1 : 0, address, value);
    } else if (address >= map_.bridge_registers) {
      write_bridge(address - map_.bridge_registers, value);
    } else if (address == core_register(fpga::registers::kControl) &&
               (value & fpga::registers::kControlStart) != 0) {
      under_way_.push_back(kCore);
    }
  }

  void wait_for_interrupt() override {
    while ((interrupts_ & enabled_) == 0 && capture_status_[0] == 0 && capture_status_[1] == 0) {
      if (under_way_.empty()) throw std::logic_error("nothing is under way");
      const int ended = under_way_.front();
      under_way_.erase(under_way_.begin());
      end(ended);
    }
  }

  std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) override {
    if (address + bytes > memory_.size()) throw std::out_of_range("memory");
    return memory_.data() + address;
  }

 private:
  enum Activity { kLeft, kRight, kCore, kToBoard, kToHost };

  std::uint64_t core_register(std::uint64_t offset) const {
    return map_.bridge_slave + pci::bridge::kCoreRegisters + offset;
  }
  void end(int ended) {
    if (ended == kCore) {
      interrupts_ |= pci::bridge::kDoorbell | (failing_write ? pci::bridge::kPostedError : 0U);
    } else if (ended >= kToBoard) {
      const auto channel = static_cast<unsigned>(ended - kToBoard);
      interrupts_ |= (failing_channel == channel ? pci::bridge::kDmaError : pci::bridge::kDmaDone) << channel;
    } else {
      const auto side = static_cast<std::size_t>(ended);
      capture_status_[side] = capture::registers::kStatusDone;
      if (failing_capture == captures_[side]++) capture_status_[side] |= capture::registers::kStatusWordsLost;
    }
  }
  void write_capture(std::size_t side, std::uint64_t address, std::uint32_t value) {
    const std::uint64_t offset = address - (side == 0 ? map_.left_capture : map_.right_capture);
    if (offset == capture::registers::kStatus) capture_status_[side] &= ~value;
    if (offset == capture::registers::kControl) under_way_.push_back(static_cast<int>(side));
  }
  void write_bridge(std::uint64_t offset, std::uint32_t value) {
    if (offset == pci::bridge::kInterruptStatus) interrupts_ &= ~value;
    if (offset == pci::bridge::kInterruptEnable) enabled_ = value;
    for (unsigned channel = 0; channel < pci::bridge::kChannels; ++channel) {
      if (offset == pci::bridge::kDmaControl + channel * pci::bridge::kChannelStride)
        under_way_.push_back(static_cast<int>(kToBoard + channel));
    }
  }

  platform::DeviceMap map_;
  std::vector<std::uint8_t> memory_;
  std::vector<int> under_way_;  // the one that was begun first is the first
  std::array<std::uint32_t, 2> capture_status_{};
  std::array<std::uint64_t, 2> captures_{};  // ended
  std::uint32_t interrupts_ = 0;
  std::uint32_t enabled_ = 0;
};

}  // namespace stereotlm::driver
