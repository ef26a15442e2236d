// The event loop of the computer, without the kernel: where it stops, the order of events of one time, and
// that it skips lines of the cameras. Random computers compare its figures with the plain event loop.
#include "platform/computer_loop.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/capture/camera_timing.h"
#include "models/capture/capture_registers.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/register_map.h"
#include "models/kernels/gray_image.h"
#include "models/pci/bridge_registers.h"
#include "platform/computer_parts.h"
#include "platform/config/board_yaml.h"
#include "tests/support/random_computer.h"
#include "tests/unit/platform/computer_registers.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

namespace capture_map = capture::registers;
using testing::kCaptures;
using testing::kDevices;

using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kEdgePs = 25'000;  // a clock of PCI, of the local bus and of the core
constexpr std::uint64_t kFar = 1'000'000'000'000;

// All pictures are the same.
class GreySource : public capture::CameraSource {
 public:
  explicit GreySource(const BoardConfig& board) : picture_(board.image.width, board.image.height, 99) {}
  const kernels::GrayImage& frame(std::uint64_t /*number*/, std::uint64_t /*begin_ps*/) override {
    return picture_;
  }

 private:
  kernels::GrayImage picture_;
};

// A processor for ComputerLoop on the small board, with another clock of the PCI bus and faster cameras. Its
// bursts follow each other. The configuration may be changed before the first call of loop().
class LoopProcessor : public pci::PciMasterIf {
 public:
  struct Burst {
    bool write = false;
    std::uint64_t address = 0;
    Words words;
    std::size_t moved = 0;  // words
  };

  ComputerLoop& loop() {
    if (loop_ == nullptr) {
      picture_.emplace(config);
      loop_ = std::make_unique<ComputerLoop>(config, memory.data(), memory.size(), *picture_, *picture_,
                                             fpga::Fidelity::kFast);
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
    while (!bursts.empty()) loop().run(loop().now_ps() + kFar);
    return results.back().end;
  }
  void write(std::uint64_t address, std::uint32_t word) {
    EXPECT_EQ(access(true, address, {word}), pci::BurstEnd::kComplete);
  }
  std::uint32_t read(std::uint64_t address) {
    EXPECT_EQ(access(false, address, {0}), pci::BurstEnd::kComplete);
    return done.words.front();
  }
  // Arms both captures.
  void arm(std::uint32_t left_bank = 1, std::uint32_t right_bank = 3) {
    for (const std::uint32_t side : {0U, 1U}) {
      write(testing::page_register(1 + side), (side == 0 ? left_bank : right_bank) << 26U);
      write(kCaptures[side] + capture_map::kBufferAddress,
            static_cast<std::uint32_t>(testing::aperture(1 + side)));
      write(kCaptures[side] + capture_map::kControl, capture_map::kControlArm);
    }
  }
  // A frame whose end raises the interrupt. Its tables have no valid entry.
  void start_core() {
    write(kDevices.bridge_registers + pci::bridge::kInterruptEnable, pci::bridge::kDoorbell);
    std::uint32_t bank = 0;
    for (const std::uint64_t base : testing::kBaseRegisters)
      write(testing::core_register(base), fpga::registers::base(bank++, 0));
    write(testing::core_register(fpga::registers::kControl), fpga::registers::kControlStart);
  }

  BoardConfig config = [] {
    BoardConfig board = testing::small_board();
    board.pci.clock_mhz = 40;
    board.cameras.frame_rate_hz = 1000;
    return board;
  }();
  std::vector<unsigned char> memory = std::vector<unsigned char>(1U << 20U);
  std::deque<Burst> bursts;
  Burst done;  // the last one that has ended
  std::vector<std::uint64_t> granted_ps;
  std::vector<pci::BurstResult> results;

 private:
  std::optional<GreySource> picture_;
  std::unique_ptr<ComputerLoop> loop_;
  Words left_words_;  // of the burst
};

class ComputerLoopTest : public ::testing::Test, public LoopProcessor {};

// The load, which had the bus last, requests the clock that begins with the interrupt. A request of the
// processor at that time comes before the decision.
TEST_F(ComputerLoopTest, LetsTheProcessorTakePartInTheDecisionsOfTheTimeOfAnInterrupt) {
  LoopProcessor first;
  first.start_core();
  const std::uint64_t started_ps = first.loop().now_ps();
  first.loop().run(kFar);
  const std::uint64_t interrupt_ps = first.loop().now_ps();
  ASSERT_EQ(interrupt_ps % kEdgePs, 0U);

  const std::uint64_t interval_ps = 200 * kEdgePs;
  ASSERT_LT(started_ps + interval_ps, interrupt_ps);
  const auto us = [](std::uint64_t ps) { return static_cast<double>(ps) / 1e6; };
  config.pci.load = PciLoadConfig{4, us(interval_ps), us(interrupt_ps - interval_ps), 0};
  start_core();
  EXPECT_EQ(loop().now_ps(), started_ps);
  loop().run(kFar);
  EXPECT_EQ(loop().now_ps(), interrupt_ps);
  EXPECT_EQ(computer_counters().pci.masters[kTrafficGenerator].transactions, 1U);
  bursts.push_back({false, kDevices.host_memory, {0}});
  request(interrupt_ps);
  loop().run(kFar);
  EXPECT_EQ(granted_ps.back(), interrupt_ps);
}

// PCI ends burst A in clock e. The only word of B is posted at e + 7, that of C at e + 14. The local bus ends
// A at e + 3 + words. With 11 words, that is when C's word comes: the bridge sends B and C in two bursts.
// With 12 words it sends both in one burst.
TEST_F(ComputerLoopTest, EndsABurstOfTheLocalBusBeforeWordsArePostedAtThatTime) {
  for (const std::size_t words : {11U, 12U}) {
    const std::uint64_t before = computer_counters().local_bus.bursts;
    std::uint64_t address = kDevices.bridge_slave;
    for (const std::size_t count : {words, std::size_t{1}, std::size_t{1}}) {
      bursts.push_back({true, address, Words(count, 7)});
      address += 4 * count;
    }
    request(loop().now_ps());
    loop().run(kFar);
    loop().run(loop().now_ps() + 100 * kEdgePs);
    EXPECT_EQ(computer_counters().local_bus.bursts - before, words == 11 ? 3U : 2U) << words;
  }
}

// At this camera rate the last pixel of a frame arrives with a clock of the bus. In the last line the load
// keeps the bus until a word finds the one-word FIFO full: the rest is dropped, and the capture ends with the
// last pixel. A write at this time that clears `done` comes first, and clears nothing; 1 ns later it does.
class ComputerLoopPixels : public ComputerLoopTest, public ::testing::WithParamInterface<bool> {};

TEST_P(ComputerLoopPixels, ArriveAfterTheWritesOfTheirTime) {
  const bool later = GetParam();
  config.pci.clock_mhz = 1000;
  config.cameras.frame_rate_hz = 249.6;
  config.capture.fifo_words = 1;
  config.capture.fifo_trigger_words = 1;
  const capture::CameraTiming timing(camera_config(config));
  const std::uint64_t frame_ps = timing.frame_ps(1);
  const std::uint64_t last_ps = frame_ps + timing.last_pixel_ps();
  ASSERT_EQ(last_ps % 1000, 0U);
  const std::uint64_t hold_ps = frame_ps + timing.pixel_ps(1, 5);
  const std::uint64_t release_ps = frame_ps + timing.pixel_ps(9, 5);
  const auto us = [](std::uint64_t ps) { return static_cast<double>(ps) / 1e6; };
  config.pci.load = PciLoadConfig{1, 1e9, us(hold_ps), us(release_ps - hold_ps)};
  arm();
  loop().run(frame_ps + timing.pixel_ps(12, 5));
  EXPECT_FALSE(loop().interrupt());
  // The write: address clock, wait clocks, one word.
  const std::uint64_t write_ps = last_ps + (later ? 1000 : 0);
  const auto clocks = static_cast<std::uint64_t>(1 + config.pci.bridge_wait_clocks + 1);
  bursts.push_back({true, kDevices.left_capture + capture_map::kStatus, {capture_map::kStatusDone}});
  request(write_ps - 1000 * clocks);
  while (results.back().end_ps < write_ps) loop().run(kFar);
  EXPECT_EQ(results.back().end_ps, write_ps);
  EXPECT_EQ(read(kDevices.left_capture + capture_map::kDroppedPixels), 12U);
  EXPECT_EQ(read(kDevices.left_capture + capture_map::kStatus), later ? 0U : capture_map::kStatusDone);
}

INSTANTIATE_TEST_SUITE_P(ComputerLoop, ComputerLoopPixels, ::testing::Bool(), [](const auto& later) {
  return later.param ? "and_before_later_ones" : "with_them";
});

// A frame begins at this very time.
TEST_F(ComputerLoopTest, TakesAFrameWhoseCapturesAreArmedAsItBegins) {
  for (const std::uint64_t late_ps : {std::uint64_t{0}, kEdgePs}) {
    SCOPED_TRACE(late_ps);
    LoopProcessor other;
    ComputerLoop& computer = other.loop();
    other.write(kDevices.left_capture + capture_map::kBufferAddress, 0);
    other.write(kDevices.right_capture + capture_map::kBufferAddress, 0);
    other.write(kDevices.right_capture + capture_map::kControl, capture_map::kControlArm);
    const std::uint64_t frame_ps = 1'000'000'000;
    other.bursts.push_back({true, kDevices.left_capture + capture_map::kControl, {capture_map::kControlArm}});
    other.request(frame_ps + late_ps - 6 * kEdgePs);
    computer.run(kFar);
    EXPECT_EQ(computer.now_ps(), frame_ps + late_ps);
    computer.run(frame_ps + 2 * kEdgePs);
    EXPECT_EQ(other.computer_counters().cameras[0].capture.started_frames, late_ps == 0 ? 1U : 0U);
  }
}

// Of four pictures of 48 lines. Some clocks have few phases against the local bus.
TEST(ComputerLoop, SkipsMostLinesOfUndisturbedPictures) {
  for (const double pci_mhz : {33.333, 20.0, 40.0, 66.0}) {
    LoopProcessor processor;
    processor.config = load_board("fpl2003", {"image.width=160", "image.height=48"});
    processor.config.cameras.frame_rate_hz = 297.3;
    processor.config.pci.clock_mhz = pci_mhz;
    for (int picture = 0; picture < 4; ++picture) {
      processor.arm();
      const std::uint64_t end_ps = processor.loop().now_ps() + 7'000'000'000;  // more than two frames
      while (processor.loop().now_ps() < end_ps) processor.loop().run(end_ps);
      for (const std::uint64_t board : kCaptures)
        processor.write(board + capture_map::kStatus, capture_map::kStatusDone);
    }
    EXPECT_GT(processor.loop().skipped_lines(), 4U * 48 / 2) << pci_mhz;
  }
}

// Lines fill the buses more or less, and lie differently against their clocks.
BoardConfig board_of_lines(test::SplitMix64 random) {
  const int words = random.between(4, 40);
  const int fifo = random.mostly_small(4, 140, 4096);
  const double pci_mhz = random.between(60'000, 1'000'000) / 1e4;
  const double local_mhz = random.chance(40) ? 40 : random.between(120'000, 1'200'000) / 1e4;
  const double line_us =
      random.between(10'000, 60'000) / 1e4 * std::max(2 * (words + 8) / pci_mhz, 2.2 * words / local_mhz);
  const int height = std::clamp(static_cast<int>(920 / line_us) + 1, random.between(12, 64), 300);
  std::vector<std::string> keys = {
      fmt::format("image={{width: {}, height: {}}}", 4 * words, height),
      fmt::format("cameras.frame_rate_hz={:.4f}", std::min(1e3, 1e6 / (line_us * height * 35 / 32))),
      fmt::format("capture.fifo_words={}", fifo),
      fmt::format("capture.fifo_trigger_words={}", random.between(1, std::min(fifo, 32))),
      fmt::format("pci.clock_mhz={}", pci_mhz),
      fmt::format("pci.latency_timer_clocks={}", random.mostly_small(0, 64, 255)),
      fmt::format("bridge.local_clock_mhz={}", local_mhz),
      fmt::format("fpga.clock_mhz={}", local_mhz),
      fmt::format("bridge.posted_words={}", random.mostly_small(3, 64, 4096)),
      fmt::format("bridge.dma_burst_words={}", random.mostly_small(1, 32, 256))};
  if (random.chance(25))
    keys.push_back(fmt::format("pci.load={{burst_words: 32, interval_us: {}}}", random.between(20, 400)));
  return load_board("fpl2003", keys);
}

// What the processor and the counters see.
std::string figures_of(LoopProcessor& processor) {
  const ComputerCounters counters = processor.computer_counters();
  std::string text =
      fmt::format("{} {} {} {} {} {} {}\n", fmt::join(processor.granted_ps, " "), counters.pci.busy_clocks,
                  counters.local_bus.bursts, counters.local_bus.busy_clocks, counters.bridge.dma_words,
                  fmt::join(counters.words.into_bridge, " "), fmt::join(counters.words.granted, " "));
  for (const BoardCounters::Bank& bank : counters.board.banks)
    text += fmt::format("{} {}\n", bank.accesses, fmt::join(bank.arbiter.counts(), " "));
  text += fmt::format("{}\n", fmt::join(processor.loop().board().frames().frame_cycles(), " "));
  for (const pci::PciBusControl::MasterStats& master : counters.pci.masters)
    text +=
        fmt::format("{} {} {} {}\n", master.transactions, master.words, master.wait_clocks, master.retries);
  for (const ComputerCounters::Camera& camera : counters.cameras)
    text +=
        fmt::format("{} {} {}\n", camera.capture.dropped_pixels, camera.capture.bursts, camera.capture.words);
  return text;
}

// What two pictures do on a board. If `steps`, the loop stops so often that no line is skipped. Every fourth
// program writes to the board and reads a register now and then. In some, both pictures go to one bank.
std::string figures_of_lines(std::uint64_t seed, bool steps, std::uint64_t& skipped) {
  LoopProcessor processor;
  processor.config = board_of_lines(test::SplitMix64(seed));
  // The bus moves at most two words in a clock.
  const std::uint64_t short_ps =
      static_cast<std::uint64_t>(processor.config.image.width * 1e6 / (4 * processor.config.pci.clock_mhz));
  ComputerLoop& loop = processor.loop();
  for (int picture = 0; picture < 2; ++picture) {
    processor.arm(1, seed % 8 == 2 ? 1 : 3);
    const std::uint64_t begin_ps = loop.now_ps();
    const std::uint64_t pause_ps = seed % 4 == 1 ? 17'000'000 + 1'234'567 * (seed % 100) : kFar;
    const auto end_ps =
        begin_ps + static_cast<std::uint64_t>(2.1e12 / processor.config.cameras.frame_rate_hz);
    for (std::uint64_t next_ps = begin_ps; loop.now_ps() < end_ps;) {
      next_ps = std::min(end_ps, next_ps + pause_ps);
      while (loop.now_ps() < next_ps) loop.run(steps ? std::min(next_ps, loop.now_ps() + short_ps) : next_ps);
      processor.access(true, testing::aperture(0), Words(8));
      processor.read(kCaptures[0] + capture_map::kStatus);
    }
    for (const std::uint64_t board : kCaptures)
      processor.write(board + capture_map::kStatus, capture_map::kStatusDone);
  }
  skipped += loop.skipped_lines();
  return figures_of(processor);
}

TEST(ComputerLoop, GivesTheSameFiguresWithSkippedAsWithSteppedLines) {
  for (std::uint64_t seed = 0; seed < test::random_computers(200); ++seed) {
    std::uint64_t stepped = 0;
    std::uint64_t skipped = 0;
    ASSERT_EQ(figures_of_lines(seed, false, skipped), figures_of_lines(seed, true, stepped)) << seed;
    EXPECT_EQ(stepped, 0U);
  }
}

using Descriptors = std::vector<std::array<std::uint32_t, 4>>;  // without the address of the next one

// Puts the chain of a channel into host memory, and starts it.
void start_dma(LoopProcessor& processor, std::uint32_t channel, Descriptors chain) {
  std::uint32_t at = 0x200 * channel;
  processor.write(testing::dma_register(channel, pci::bridge::kDmaDescriptor), at);
  for (auto& descriptor : chain) {
    descriptor[3] = &descriptor == &chain.back() ? 0 : at + 16;
    std::memcpy(processor.memory.data() + at, descriptor.data(), sizeof descriptor);
    at += 16;
  }
  processor.write(testing::dma_register(channel, pci::bridge::kDmaControl), 1);
}

// Descriptors that move words between host memory and bank 7, or bank 2, which a frame uses.
Descriptors random_chain(const LoopProcessor& processor, test::SplitMix64& random) {
  const int burst = processor.config.bridge.dma_burst_words;
  Descriptors chain(static_cast<std::size_t>(random.between(1, 3)));
  for (auto& descriptor : chain) {
    const int words = random.between(0, 50) * burst + (random.chance(50) ? burst : random.between(1, burst));
    const int end = static_cast<int>(processor.memory.size());
    const int host =
        random.chance(15) ? end - 4 * burst * random.between(3, 40) : 0x400 * random.between(64, 900);
    descriptor = {static_cast<std::uint32_t>(host),
                  random.chance(60) ? 7U << 26U | static_cast<std::uint32_t>(random.between(0, 20'000))
                                    : 2U << 26U | 200'000U,
                  static_cast<std::uint32_t>(words) | (random.chance(50) ? pci::bridge::kToPci : 0)};
  }
  return chain;
}

// What chains of DMA do on a board, beside captures or a frame in some of the seeds. If `steps`, the loop
// stops so often that no burst is skipped.
std::string figures_of_dma(std::uint64_t seed, bool steps, std::uint64_t& skipped) {
  test::SplitMix64 random(seed);
  LoopProcessor processor;
  processor.config = board_of_lines(random);
  if (random.chance(30)) processor.config.pci.clock_mhz = 2 * processor.config.bridge.local_clock_mhz;
  if (random.chance(50)) {  // the host comes first
    memory::PriorityList& priority = processor.config.fpga.arbiter.priority;
    std::rotate(priority.begin(), std::find(priority.begin(), priority.end(), fpga::CorePorts(1).host()),
                priority.end());
  }
  for (std::size_t byte = 0; byte < processor.memory.size(); ++byte)
    processor.memory[byte] = static_cast<unsigned char>(random.next());
  // A burst on the local bus takes longer.
  const auto short_ps = static_cast<std::uint64_t>(
      1e6 * processor.config.bridge.dma_burst_words /
      std::max(processor.config.pci.clock_mhz, processor.config.bridge.local_clock_mhz));
  ComputerLoop& loop = processor.loop();
  const auto run_to = [&](std::uint64_t time_ps) {
    for (;;) {
      while (loop.interrupt()) {
        processor.write(kDevices.bridge_registers + pci::bridge::kInterruptStatus, pci::bridge::kDoorbell);
        for (const std::uint64_t board : kCaptures)
          processor.write(board + capture_map::kStatus,
                          capture_map::kStatusDone | capture_map::kStatusWordsLost);
      }
      if (loop.now_ps() >= time_ps) return;
      loop.run(steps ? std::min(time_ps, loop.now_ps() + short_ps) : time_ps);
    }
  };
  processor.write(testing::page_register(0), 7U << 26U);
  if (random.chance(30)) processor.arm(5, 6);
  if (random.chance(60)) processor.start_core();
  run_to(loop.now_ps() + static_cast<std::uint64_t>(random.between(0, 300'000'000)));
  start_dma(processor, static_cast<std::uint32_t>(seed % 2), random_chain(processor, random));
  run_to(loop.now_ps() + static_cast<std::uint64_t>(random.between(0, 300'000'000)));
  if (random.chance(30))
    start_dma(processor, static_cast<std::uint32_t>(1 - seed % 2), random_chain(processor, random));
  const std::uint64_t pause_ps = random.chance(30) ? 7'000'000 + 1'234'567 * (seed % 100) : kFar;
  for (const std::uint64_t end_ps = loop.now_ps() + 4'000'000'000; loop.now_ps() < end_ps;) {
    run_to(std::min(end_ps, loop.now_ps() + pause_ps));
    processor.access(false, testing::aperture(0), Words(3));
  }
  skipped += loop.skipped_dma_bursts();
  std::string text = figures_of(processor);
  text += fmt::format("{}\n",
                      std::hash<std::string_view>()(
                          {reinterpret_cast<const char*>(processor.memory.data()), processor.memory.size()}));
  text += fmt::format("{}\n", processor.read(kDevices.bridge_registers + pci::bridge::kInterruptStatus));
  EXPECT_EQ(processor.access(false, testing::aperture(0), Words(1000)), pci::BurstEnd::kComplete);
  return text + fmt::format("{}", fmt::join(processor.done.words, " "));
}

TEST(ComputerLoop, GivesTheSameFiguresWithSkippedAsWithSteppedDmaBursts) {
  std::uint64_t skipped = 0;
  for (std::uint64_t seed = 0; seed < test::random_computers(200); ++seed) {
    std::uint64_t stepped = 0;
    ASSERT_EQ(figures_of_dma(seed, false, skipped), figures_of_dma(seed, true, stepped)) << seed;
    EXPECT_EQ(stepped, 0U);
  }
  EXPECT_GT(skipped, 10U * test::random_computers(200));
}

// A step of the channel takes 35 clocks of the local bus. In one of the runs a frame ends as a step begins.
// In another one the processor's read reaches the bridge then.
TEST(ComputerLoop, SkipsNoDmaBurstsBehindWhatTheProcessorSees) {
  for (std::uint64_t clock = 0; clock < 35; ++clock) {
    std::array<std::string, 2> figures;  // with skipped and with stepped bursts
    for (const bool steps : {false, true}) {
      LoopProcessor processor;
      processor.config.pci.clock_mhz = 80;
      processor.config.banks[7].words = 8192;
      ComputerLoop& loop = processor.loop();
      processor.start_core();
      loop.run(loop.now_ps() + clock * kEdgePs);
      start_dma(processor, 0, {{0x10000, 7U << 26U, 200 * 32, 0}});
      while (!loop.interrupt()) loop.run(loop.now_ps() + (steps ? 20 * kEdgePs : kFar));
      processor.write(kDevices.bridge_registers + pci::bridge::kInterruptStatus, pci::bridge::kDoorbell);
      processor.access(false, testing::aperture(0), Words(3));
      for (const std::uint64_t end_ps = loop.now_ps() + 1'000'000'000; loop.now_ps() < end_ps;)
        loop.run(steps ? loop.now_ps() + 20 * kEdgePs : end_ps);
      EXPECT_EQ(loop.skipped_dma_bursts() != 0, !steps);
      figures[steps ? 1 : 0] = figures_of(processor);
    }
    ASSERT_EQ(figures[0], figures[1]) << clock;
  }
}

TEST_F(ComputerLoopTest, RefusesBurstsOfSeveralWordsToRegisters) {
  for (const bool write : {true, false}) {
    for (const std::uint64_t address :
         {kDevices.bridge_registers, kDevices.left_capture + capture_map::kStatus})
      EXPECT_EQ(access(write, address, Words(2)), pci::BurstEnd::kTargetError);
  }
  EXPECT_EQ(computer_counters().bridge.errors, 2U);
  EXPECT_EQ(computer_counters().cameras[0].capture.refused_accesses, 2U);
  EXPECT_EQ(access(true, kDevices.host_memory, Words(2)), pci::BurstEnd::kComplete);
}

TEST_F(ComputerLoopTest, RefusesABoardWithProblems) {
  config.allocation.left_lut = "bank9";
  EXPECT_THROW(loop(), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::platform
