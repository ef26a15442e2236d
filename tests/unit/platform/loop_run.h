#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/kernels/gray_image.h"
#include "models/pci/bridge_registers.h"
#include "platform/computer_loop.h"
#include "platform/device_map.h"
#include "tests/support/random_board.h"

namespace stereotlm::platform::testing {

inline constexpr DeviceMap kRunMap;
inline constexpr std::array<std::uint64_t, 2> kLoopCaptures = {kRunMap.left_capture, kRunMap.right_capture};
// Longer than anything that is skipped, and than any frame of the core.
inline constexpr std::uint64_t kLongPs = 1'000'000'000'000;
inline constexpr std::uint64_t kFramePs = 10'000'000'000;

// Pictures of noise, another one in each frame.
class NoiseSource : public capture::CameraSource {
 public:
  NoiseSource(const BoardConfig& board, std::uint64_t seed)
      : seed_(seed), picture_(board.image.width, board.image.height, 0) {}
  const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t /*begin_ps*/) override {
    test::SplitMix64 random(seed_ + number);
    for (std::uint8_t& pixel : picture_.pixels) pixel = static_cast<std::uint8_t>(random.next() >> 56U);
    return picture_;
  }

 private:
  std::uint64_t seed_;
  kernels::GrayImage picture_;
};

// A processor for ComputerLoop, which notes the times of its accesses and of the interrupts. The loop runs
// for at most `step_ps` at a time: nothing can be skipped that does not end within such a step.
class LoopRun : public pci::PciMasterIf {
 public:
  LoopRun(const BoardConfig& board, fpga::Fidelity fidelity, std::uint64_t step_ps)
      : step_ps_(step_ps),
        left_(board, 1'000),
        right_(board, 2'000),
        loop_(board, memory_.data(), memory_.size(), left_, right_, fidelity) {}

  pci::PciBurst begin_burst(std::uint64_t /*address_clock_ps*/) override {
    return {writes_, address_, &words_};
  }
  void end_burst(const pci::BurstResult& result) override {
    note("burst {} {}\n", result.end_ps, static_cast<int>(result.end));
    const auto rest = words_.begin() + static_cast<std::ptrdiff_t>(result.words);
    done_.insert(done_.end(), words_.begin(), rest);
    words_.erase(words_.begin(), is_error(result.end) ? words_.end() : rest);
    address_ += 4 * result.words;
    if (words_.empty()) {
      loop_.notice();
    } else {
      loop_.host_slot().request(*this, result.end_ps);
    }
  }

 protected:
  template <class... T>
  void note(fmt::format_string<T...> format, T&&... values) {
    figures_ += fmt::format(format, std::forward<T>(values)...);
  }
  const std::string& figures() const { return figures_; }
  ComputerLoop& loop() { return loop_; }
  const ComputerLoop& loop() const { return loop_; }
  std::vector<unsigned char>& memory() { return memory_; }

  void write(std::uint64_t address, std::uint32_t word) {
    writes_ = true;
    address_ = address;
    words_ = {word};
    access();
  }
  std::vector<std::uint32_t> read(std::uint64_t address, std::size_t words) {
    writes_ = false;
    address_ = address;
    words_.assign(words, 0);
    access();
    return done_;
  }
  void run_for(std::uint64_t time_ps) {
    const std::uint64_t end_ps = loop_.now_ps() + time_ps;
    while (loop_.now_ps() < end_ps) {
      const bool level = loop_.interrupt();
      loop_.run(std::min(end_ps, loop_.now_ps() + step_ps_));
      if (loop_.interrupt() != level) note("interrupt {}\n", loop_.now_ps());
    }
  }
  // The end of the run, when nothing is compared any more but the sums: all that is under way ends.
  void finish() {
    const std::uint64_t end_ps = loop_.now_ps() + kFramePs;
    while (loop_.now_ps() < end_ps) loop_.run(end_ps);
  }
  // Runs to the next interrupt, for `most_ps` at most. Returns whether it has come.
  bool run_to_interrupt(std::uint64_t most_ps) {
    const std::uint64_t end_ps = loop_.now_ps() + most_ps;
    while (!loop_.interrupt() && loop_.now_ps() < end_ps)
      loop_.run(std::min(end_ps, loop_.now_ps() + step_ps_));
    note("interrupt {} {}\n", loop_.interrupt(), loop_.now_ps());
    return loop_.interrupt();
  }
  // The five buffers of the frame are in `bank` and the next four. Its tables have no valid entry.
  void start_frame(std::uint32_t bank) {
    namespace core = fpga::registers;
    const std::uint64_t registers = kRunMap.bridge_slave + pci::bridge::kCoreRegisters;
    for (const std::uint64_t base : {core::kLeftImageBase, core::kRightImageBase, core::kDisparityBase,
                                     core::kLeftLutBase, core::kRightLutBase})
      write(registers + base, core::base(bank++, 0x10000));
    write(registers + core::kControl, core::kControlStart);
  }
  // The first descriptor is at `address` in host memory.
  void start_dma(std::uint64_t channel, std::uint32_t address) {
    const std::uint64_t registers = kRunMap.bridge_registers + pci::bridge::kChannelStride * channel;
    write(registers + pci::bridge::kDmaDescriptor, address);
    write(registers + pci::bridge::kDmaControl, 1);
  }
  void arm_captures() {
    write(kLoopCaptures[1] + capture::registers::kControl, capture::registers::kControlArm);
    write(kLoopCaptures[0] + capture::registers::kControl,
          capture::registers::kControlArm | capture::registers::kControlTrigger);
  }
  std::string counters() const {
    const ComputerCounters counters = loop_.counters();
    std::string text = fmt::format("pci {} {}\n", counters.pci.clocks, counters.pci.busy_clocks);
    for (const pci::PciBusControl::MasterStats& master : counters.pci.masters) {
      text += fmt::format("{} {} {} {} {} {}\n", master.name, master.transactions, master.words,
                          master.wait_clocks, master.retries, master.aborts);
    }
    const pci::BridgeControl::Stats& bridge = counters.bridge;
    text += fmt::format("bridge {} {} {} {} {}\n", bridge.posted_words, bridge.slave_reads, bridge.dma_words,
                        bridge.most_posted_words, bridge.errors);
    const fpga::LocalBusControl::Stats& local = counters.local_bus;
    text += fmt::format("local bus {} {} {} {} {} {}\n", local.bursts, local.words_read, local.words_written,
                        local.errors, local.clocks, local.busy_clocks);
    const ComputerCounters::Words& words = counters.words;
    text +=
        fmt::format("words {} {} {} {}\n", fmt::join(words.into_bridge, " "), fmt::join(words.in_bridge, " "),
                    fmt::join(words.on_bus, " "), fmt::join(words.granted, " "));
    for (const ComputerCounters::Camera& camera : counters.cameras) {
      const capture::CaptureControl::Stats& capture = camera.capture;
      text += fmt::format("camera {} {} {} {} {} {} {}\n", camera.frames, capture.captured_frames,
                          capture.dropped_frames(), capture.dropped_pixels, capture.bursts, capture.words,
                          capture.lost_words);
    }
    for (const auto& bank : counters.board.banks) {
      text += fmt::format("bank {} {} {} {} {}\n", bank.accesses, bank.uncounted_grants, bank.arbiter.writes,
                          bank.arbiter.idle_cycles, bank.arbiter.busy_cycles);
    }
    return text;
  }

 private:
  void access() {
    done_.clear();
    loop_.host_slot().request(*this, loop_.now_ps());
    while (!words_.empty()) loop_.run(loop_.now_ps() + kLongPs);
  }

  std::uint64_t step_ps_;
  std::vector<unsigned char> memory_ = std::vector<unsigned char>(1U << 20U);
  NoiseSource left_;
  NoiseSource right_;
  ComputerLoop loop_;
  bool writes_ = false;
  std::uint64_t address_ = 0;
  std::vector<std::uint32_t> words_;  // of the burst that are still to be transferred
  std::vector<std::uint32_t> done_;   // the others
  std::string figures_;
};

}  // namespace stereotlm::platform::testing
