#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/kernels/gray_image.h"
#include "models/pci/bridge_registers.h"
#include "platform/bus_trace.h"
#include "platform/computer_loop.h"
#include "platform/config/board_yaml.h"
#include "tests/support/random_board.h"
#include "tests/unit/platform/computer_registers.h"

namespace stereotlm::platform::testing {

using Words = std::vector<std::uint32_t>;
using Keys = std::vector<std::string>;  // of a board

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

// A processor for ComputerLoop, whose bursts follow each other. The configuration may be changed before the
// first call of loop().
class LoopProcessor : public pci::PciMasterIf {
 public:
  struct Burst {
    bool write = false;
    std::uint64_t address = 0;
    Words words;
    std::size_t moved = 0;  // words
  };

  explicit LoopProcessor(const BoardConfig& board, fpga::Fidelity fidelity = fpga::Fidelity::kFast)
      : config(board), fidelity_(fidelity), left_(board, 1'000), right_(board, 2'000) {}

  ComputerLoop& loop() {
    if (loop_ == nullptr) {
      loop_ = std::make_unique<ComputerLoop>(config, memory.data(), memory.size(), left_, right_, fidelity_);
    }
    return *loop_;
  }
  // To be called while the core runs no frame.
  ComputerCounters computer_counters() {
    return loop().controls().counters(loop().board().counters(), loop().now_ps());
  }

  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    granted_ps.push_back(address_clock_ps);
    const Burst& burst = bursts.front();
    left_words_.assign(burst.words.begin() + static_cast<std::ptrdiff_t>(burst.moved), burst.words.end());
    return {burst.write, burst.address + 4 * burst.moved, &left_words_};
  }
  // A burst that was cut continues with its next word.
  void end_burst(const pci::BurstResult& result) override {
    results.push_back(result);
    Burst& burst = bursts.front();
    std::copy_n(left_words_.begin(), result.words,
                burst.words.begin() + static_cast<std::ptrdiff_t>(burst.moved));
    burst.moved += result.words;
    if (is_error(result.end) || burst.moved == burst.words.size()) {
      done = std::move(burst);
      bursts.pop_front();
    }
    if (bursts.empty()) {
      loop().notice();
    } else {
      request(result.end_ps);
    }
  }
  void request(std::uint64_t from_ps) { loop().host_slot().request(*this, from_ps); }
  // Runs one burst to its end.
  pci::BurstEnd access(bool write, std::uint64_t address, Words words) {
    bursts.push_back({write, address, std::move(words)});
    request(loop().now_ps());
    while (!bursts.empty()) loop().run(loop().now_ps() + kLongPs);
    return results.back().end;
  }
  void write(std::uint64_t address, std::uint32_t word) {
    EXPECT_EQ(access(true, address, {word}), pci::BurstEnd::kComplete);
  }
  Words read(std::uint64_t address, std::size_t words) {
    EXPECT_EQ(access(false, address, Words(words)), pci::BurstEnd::kComplete);
    return done.words;
  }
  std::uint32_t read(std::uint64_t address) { return read(address, 1).front(); }
  // The five buffers of the frame are in `bank` and the next four. Its tables have no valid entry.
  void start_frame(std::uint32_t bank, std::uint32_t word = 0x10000) {
    for (const std::uint64_t base : kBaseRegisters)
      write(core_register(base), fpga::registers::base(bank++, word));
    write(core_register(fpga::registers::kControl), fpga::registers::kControlStart);
  }

  BoardConfig config;
  std::vector<unsigned char> memory = std::vector<unsigned char>(1U << 20U);
  std::deque<Burst> bursts;
  Burst done;  // the last one that has ended
  std::vector<std::uint64_t> granted_ps;
  std::vector<pci::BurstResult> results;

 private:
  fpga::Fidelity fidelity_;
  NoiseSource left_;
  NoiseSource right_;
  std::unique_ptr<ComputerLoop> loop_;
  Words left_words_;  // of the burst
};

// The records of a trace, one a line.
class TraceText : public BusObserver {
 public:
  void burst(const BusBurst& burst) override {
    text +=
        fmt::format("{} {} {} {} {} {} {} {} {}\n", burst.master, burst.target, burst.write, burst.address,
                    burst.words, burst.request_ps, burst.address_ps, burst.data_ps, burst.end_ps);
  }
  void level(const QueueLevel& level) override {
    text += fmt::format("{} {} {}\n", level.queue, level.time_ps, level.words);
  }

  std::string text;
};

// A processor that notes the times of its accesses and of the interrupts. The loop runs for at most `step_ps`
// at a time: nothing can be skipped that does not end within such a step.
class LoopRun : public LoopProcessor {
 public:
  LoopRun(const BoardConfig& board, fpga::Fidelity fidelity, std::uint64_t step_ps)
      : LoopProcessor(board, fidelity), step_ps_(step_ps) {}

  void end_burst(const pci::BurstResult& result) override {
    note("burst {} {}\n", result.end_ps, static_cast<int>(result.end));
    LoopProcessor::end_burst(result);
  }

 protected:
  template <class... T>
  void note(fmt::format_string<T...> format, T&&... values) {
    figures_ += fmt::format(format, std::forward<T>(values)...);
  }
  const std::string& figures() const { return figures_; }

  void run_for(std::uint64_t time_ps) {
    const std::uint64_t end_ps = loop().now_ps() + time_ps;
    while (loop().now_ps() < end_ps) {
      const bool level = loop().interrupt();
      loop().run(std::min(end_ps, loop().now_ps() + step_ps_));
      if (loop().interrupt() != level) note("interrupt {}\n", loop().now_ps());
    }
  }
  // The end of the run, when nothing is compared any more but the sums: all that is under way ends.
  void finish() {
    const std::uint64_t end_ps = loop().now_ps() + kFramePs;
    while (loop().now_ps() < end_ps) loop().run(end_ps);
  }
  // The first descriptor is at `address` in host memory.
  void start_dma(std::uint64_t channel, std::uint32_t address) {
    write(dma_register(channel, pci::bridge::kDmaDescriptor), address);
    write(dma_register(channel, pci::bridge::kDmaControl), 1);
  }
  void arm_captures() {
    write(kCaptures[1] + capture::registers::kControl, capture::registers::kControlArm);
    write(kCaptures[0] + capture::registers::kControl,
          capture::registers::kControlArm | capture::registers::kControlTrigger);
  }
  // To be called first, if the run is to be traced.
  void trace(const fpga::CycleWindow& window) {
    trace_.emplace(config, window, trace_text_);
    loop().controls().trace_buses(*trace_);
    loop().trace_buses(*trace_);
  }
  // What was traced.
  const std::string& traced() {
    if (trace_) trace_->hand_out(loop().now_ps());
    return trace_text_.text;
  }
  std::string counters() {
    const ComputerCounters counters = computer_counters();
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
  std::uint64_t step_ps_;
  std::string figures_;
  TraceText trace_text_;
  std::optional<BusTrace> trace_;
};

// A window of up to an eighth of a run.
inline fpga::CycleWindow random_window(test::SplitMix64& random, const BoardConfig& board, double run_ps) {
  const double cycles = run_ps * board.fpga.clock_mhz / 1e6;
  fpga::CycleWindow window;
  window.first = static_cast<std::uint64_t>(cycles * random.between(0, 9'999) / 1e4);
  window.last =
      window.first + static_cast<std::uint64_t>(cycles) / (std::uint64_t{8} << random.between(0, 8));
  return window;
}

struct LoopOutcome {
  std::string figures;
  std::uint64_t skipped = 0;
};

// What a program does on a board. Expects the same figures, times and words if nothing is skipped: everything
// that is skipped takes longer than `short_ps`.
template <class Run, class Program>
LoopOutcome compare_with_steps(const BoardConfig& board, const Program& program, std::uint64_t short_ps) {
  const LoopOutcome skipping = Run(board, program, kLongPs).outcome();
  const LoopOutcome stepped = Run(board, program, short_ps).outcome();
  EXPECT_EQ(stepped.skipped, 0U);
  EXPECT_EQ(skipping.figures, stepped.figures) << to_yaml(board);
  return skipping;
}

// A small board of the paper, with other keys.
inline BoardConfig loop_board(double frame_rate_hz, const Keys& keys) {
  Keys all = {"image.width=160", "image.height=48", fmt::format("cameras.frame_rate_hz={}", frame_rate_hz),
              "cameras.trigger=on_demand"};
  all.insert(all.end(), keys.begin(), keys.end());
  return load_board("fpl2003", all);
}

inline int one_of(test::SplitMix64& random, const std::vector<int>& values) {
  return values[static_cast<std::size_t>(random.between(0, static_cast<int>(values.size()) - 1))];
}
inline double decimal(test::SplitMix64& random, int low, int high) {
  return random.between(10'000 * low, 10'000 * high) / 1e4;
}

// Buses of which either is the slower one, or both are alike, and banks without turnaround.
struct RandomBuses {
  double pci_mhz;
  double local_mhz;
  int burst_words;
  Keys keys;
};
inline RandomBuses random_buses(test::SplitMix64& random) {
  RandomBuses buses;
  buses.pci_mhz = random.chance(60) ? decimal(random, 6, 150) : one_of(random, {20, 30, 33, 50, 66, 80});
  buses.local_mhz = random.chance(40) ? 40 : decimal(random, 12, 120);
  buses.burst_words = one_of(random, {1, 2, 7, 32, 32, 256});
  buses.keys = {
      fmt::format("pci.clock_mhz={}", buses.pci_mhz),
      fmt::format("pci.latency_timer_clocks={}", one_of(random, {0, 1, 5, 16, 64, 255})),
      fmt::format("pci.width_bits={}", one_of(random, {32, 64})),
      fmt::format("bridge.local_clock_mhz={}", buses.local_mhz),
      fmt::format("fpga.clock_mhz={}", buses.local_mhz),
      fmt::format("bridge.dma_burst_words={}", buses.burst_words),
      fmt::format("fpga.arbitration={}", random.chance(50) ? "age" : "round_robin"),
      fmt::format("ssram.default={{words: 131072, kind: {}}}", random.chance(50) ? "zbt_pipelined" : "qdr"),
  };
  return buses;
}

// The key of a traffic generator with a probability of 25 %, else none.
inline Keys random_load(test::SplitMix64& random, int least_interval_us, int most_interval_us,
                        int most_first_us) {
  if (!random.chance(25)) return {};
  return {fmt::format("pci.load={{burst_words: {}, interval_us: {}, first_us: {}}}", one_of(random, {1, 32}),
                      decimal(random, least_interval_us, most_interval_us),
                      decimal(random, 1, most_first_us))};
}

}  // namespace stereotlm::platform::testing
