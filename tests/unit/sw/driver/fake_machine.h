#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/host/program.h"
#include "models/pci/bridge_registers.h"
#include "platform/device_map.h"
#include "tests/support/random_board.h"

namespace stereotlm::driver {

// A computer without time for pictures of one word: whatever is under way ends, one thing after the other and
// in an order without pattern, when the program waits for an interrupt. It checks that nobody touches a
// buffer that somebody else works on. Capture k writes pair_word(k, side); the core writes result_word() of
// what it finds.
class FakeMachine : public host::HostBus {
 public:
  explicit FakeMachine(std::uint64_t seed, std::uint64_t memory_bytes = 1U << 16U)
      : random_(seed), memory_(memory_bytes) {}

  static std::uint32_t pair_word(std::uint64_t capture, std::size_t side) {
    return static_cast<std::uint32_t>(capture * 2 + side + 1);
  }
  static std::uint64_t camera_frame(std::uint64_t capture) { return capture << 32U | capture * 3; }
  static std::uint32_t result_word(std::uint32_t left, std::uint32_t right) { return left * 100'000 + right; }

  std::map<std::uint32_t, std::uint32_t> board;  // by board word
  std::uint64_t core_starts = 0;
  std::uint64_t captures = 0;                      // pairs armed
  std::optional<std::uint64_t> failing_capture;    // loses words
  std::optional<std::uint64_t> diverging_capture;  // its sides take different frames
  bool failing_write = false;                      // the board refuses one that was posted
  bool failing_core = false;
  std::optional<std::uint32_t> failing_channel;

  std::uint32_t read(std::uint64_t address) override {
    if (address == map_.bridge_registers + pci::bridge::kInterruptStatus) return interrupts_;
    if (address == core_register(fpga::registers::kStatus)) {
      return (core_busy_ ? fpga::registers::kStatusBusy : 0U) |
             (core_done_ ? fpga::registers::kStatusDone : 0U) |
             (failing_core ? fpga::registers::kStatusError : 0U);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const std::uint64_t base = capture_base(side);
      if (address == base + capture::registers::kStatus) return capture_[side].status;
      const std::uint64_t frame = camera_frame(capture_[side].frame) +
                                  (side == 1 && diverging_capture == capture_[side].frame ? 1 : 0);
      if (address == base + capture::registers::kFrameNumberLow) return static_cast<std::uint32_t>(frame);
      if (address == base + capture::registers::kFrameNumberHigh)
        return static_cast<std::uint32_t>(frame >> 32U);
    }
    throw host::BusError("read of " + std::to_string(address));
  }

  void write(std::uint64_t address, std::uint32_t value) override {
    if (address >= map_.left_capture) return write_capture(address, value);
    if (address >= map_.bridge_registers) return write_bridge(address - map_.bridge_registers, value);
    if (address >= core_register(0)) return write_core(address - core_register(0), value);
    throw host::BusError("write of " + std::to_string(address));
  }

  void wait_for_interrupt() override {
    while (!asserted()) {
      std::vector<int> under_way;
      for (const int thing : {0, 1, 2, 3, 4}) {
        if (is_under_way(thing)) under_way.push_back(thing);
      }
      if (under_way.empty()) throw std::logic_error("nothing is under way");
      const auto last = static_cast<int>(under_way.size()) - 1;
      end(under_way[static_cast<std::size_t>(random_.between(0, last))]);
    }
  }

  std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) override {
    if (address + bytes > memory_.size()) throw std::out_of_range("memory");
    return memory_.data() + address;
  }

 private:
  using Descriptor = std::array<std::uint32_t, 4>;
  struct Capture {
    bool under_way = false;
    std::uint32_t status = 0;
    std::uint32_t address = 0;
    std::optional<std::uint32_t> board_word;  // the board word that it fills; nullopt for host memory
    std::uint64_t frame = 0;
  };
  std::uint64_t capture_base(std::size_t side) const {
    return side == 0 ? map_.left_capture : map_.right_capture;
  }
  std::uint64_t core_register(std::uint64_t offset) const {
    return map_.bridge_slave + pci::bridge::kCoreRegisters + offset;
  }
  bool asserted() const {
    bool captured = false;
    for (const Capture& side : capture_) captured |= (side.status & ~capture::registers::kStatusArmed) != 0;
    return (interrupts_ & enabled_) != 0 || captured;
  }
  // 0, 1: captures; 2: the core; 3, 4: DMA channels.
  bool is_under_way(int thing) const {
    if (thing < 2) return capture_[static_cast<std::size_t>(thing)].under_way;
    return thing == 2 ? core_busy_ : dma_[static_cast<std::size_t>(thing - 3)].has_value();
  }
  void end(int thing) {
    if (thing < 2) {
      end_capture(static_cast<std::size_t>(thing));
    } else if (thing == 2) {
      end_core();
    } else {
      end_dma(static_cast<std::size_t>(thing - 3));
    }
  }

  void write_capture(std::uint64_t address, std::uint32_t value) {
    const std::size_t side = address >= map_.right_capture ? 1 : 0;
    Capture& grabber = capture_[side];
    const std::uint64_t offset = address - capture_base(side);
    if (offset == capture::registers::kBufferAddress) {
      grabber.address = value;
    } else if (offset == capture::registers::kStatus) {
      grabber.status &= ~value;
    } else if (offset == capture::registers::kControl) {
      EXPECT_FALSE(grabber.under_way) << "armed while it captures";
      EXPECT_NE(value & capture::registers::kControlArm, 0U);
      grabber.board_word = board_word(grabber.address);
      if (grabber.board_word) expect_free(*grabber.board_word);
      grabber.under_way = true;
      grabber.frame = armed_++ / 2;
    } else {
      throw host::BusError("write of a capture board");
    }
  }
  // Of an address in the bridge's window; none in host memory.
  std::optional<std::uint32_t> board_word(std::uint32_t address) const {
    if (address < map_.bridge_slave) return std::nullopt;
    const std::uint64_t offset = address - map_.bridge_slave;
    EXPECT_EQ(offset % pci::bridge::kApertureBytes, 0U);
    return pages_.at(static_cast<std::size_t>(offset / pci::bridge::kApertureBytes));
  }
  void end_capture(std::size_t side) {
    Capture& grabber = capture_[side];
    grabber.under_way = false;
    grabber.status |= capture::registers::kStatusDone;
    if (failing_capture == grabber.frame) grabber.status |= capture::registers::kStatusWordsLost;
    const std::uint32_t word = pair_word(grabber.frame, side);
    if (grabber.board_word) {
      board[*grabber.board_word] = word;
    } else {
      std::memcpy(memory(grabber.address, 4), &word, 4);
    }
  }

  void write_core(std::uint64_t offset, std::uint32_t value) {
    namespace regs = fpga::registers;
    if (offset != regs::kControl) {
      bases_[offset] = value;
      return;
    }
    if ((value & regs::kControlAcknowledge) != 0) {
      EXPECT_TRUE(core_done_) << "nothing is to be acknowledged";
      core_done_ = false;
    }
    if ((value & regs::kControlStart) == 0) return;
    EXPECT_FALSE(core_busy_);
    EXPECT_FALSE(core_done_) << "not acknowledged: the doorbell would not ring again";
    for (const auto base : {regs::kLeftImageBase, regs::kRightImageBase, regs::kDisparityBase})
      expect_free(bases_.at(base));
    core_busy_ = true;
    running_ = {bases_.at(regs::kLeftImageBase), bases_.at(regs::kRightImageBase),
                bases_.at(regs::kDisparityBase)};
    ++core_starts;
  }
  void end_core() {
    core_busy_ = false;
    core_done_ = true;
    interrupts_ |= pci::bridge::kDoorbell;
    if (failing_write) interrupts_ |= pci::bridge::kPostedError;
    board[running_[2]] = result_word(board.at(running_[0]), board.at(running_[1]));
  }

  void write_bridge(std::uint64_t offset, std::uint32_t value) {
    namespace regs = pci::bridge;
    if (offset < regs::kPage + 16) {
      pages_[static_cast<std::size_t>(offset / 4)] = value;
    } else if (offset == regs::kInterruptStatus) {
      interrupts_ &= ~value;
    } else if (offset == regs::kInterruptEnable) {
      enabled_ = value;
    } else {
      const auto channel = static_cast<std::size_t>((offset - regs::kDmaDescriptor) / regs::kChannelStride);
      if (offset % regs::kChannelStride == 0) {
        descriptors_.at(channel) = value;
      } else {
        EXPECT_FALSE(dma_.at(channel).has_value()) << "started while it is busy";
        for (const Descriptor& piece : chain(descriptors_[channel])) expect_free(piece[1]);
        dma_[channel] = chain(descriptors_[channel]);
      }
    }
  }
  std::vector<Descriptor> chain(std::uint32_t first) {
    std::vector<Descriptor> pieces;
    for (std::uint32_t next = first;;) {
      std::memcpy(pieces.emplace_back().data(), memory(next, 16), 16);
      next = pieces.back()[3];
      if (next == 0) return pieces;
    }
  }
  void end_dma(std::size_t channel) {
    const std::vector<Descriptor> pieces = *dma_[channel];
    dma_[channel].reset();
    interrupts_ |= (failing_channel == channel ? pci::bridge::kDmaError : pci::bridge::kDmaDone) << channel;
    for (const Descriptor& piece : pieces) {
      const bool to_pci = (piece[2] & pci::bridge::kToPci) != 0;
      const std::uint32_t words = piece[2] & ~pci::bridge::kToPci;
      for (std::uint32_t word = 0; word < words; ++word) {
        if (to_pci) {
          std::memcpy(memory(piece[0] + word * 4, 4), &board.at(piece[1] + word), 4);
        } else {
          std::memcpy(&board[piece[1] + word], memory(piece[0] + word * 4, 4), 4);
        }
      }
    }
  }

  // Nobody works on the buffer that begins at this board word.
  void expect_free(std::uint32_t word) {
    for (const Capture& grabber : capture_) {
      EXPECT_FALSE(grabber.under_way && grabber.board_word == word) << "a capture fills it";
    }
    EXPECT_FALSE(core_busy_ && (word == running_[0] || word == running_[1] || word == running_[2]))
        << "the core works on it";
    for (const auto& pieces : dma_) {
      if (!pieces) continue;
      for (const Descriptor& piece : *pieces) EXPECT_NE(piece[1], word) << "a DMA channel works on it";
    }
  }

  platform::DeviceMap map_;
  test::SplitMix64 random_;
  std::vector<std::uint8_t> memory_;
  std::array<Capture, 2> capture_{};
  std::uint64_t armed_ = 0;  // both sides together
  std::array<std::uint32_t, 4> pages_{};
  std::uint32_t interrupts_ = 0;
  std::uint32_t enabled_ = 0;
  std::map<std::uint64_t, std::uint32_t> bases_;
  std::array<std::uint32_t, 3> running_{};
  bool core_busy_ = false;
  bool core_done_ = false;
  std::array<std::uint32_t, 2> descriptors_{};
  std::array<std::optional<std::vector<Descriptor>>, 2> dma_;
};

}  // namespace stereotlm::driver
