// LoopComputer beside Computer, with the same program: every access and every interrupt at the same time.
#include "platform/loop/loop_computer.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/testing/monitoring_binder.h"
#include "platform/assembly/computer.h"
#include "tests/support/fork.h"
#include "tests/support/random_board.h"
#include "tests/unit/platform/computer_registers.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

namespace bridge = pci::bridge;
namespace core = fpga::registers;
namespace capture_map = capture::registers;
using fpga::Fidelity;

using testing::core_register;
using testing::kCaptures;
using testing::kDevices;

constexpr std::uint64_t kMemoryBytes = 65'536;

// Each frame is a picture of its own.
class CountedPictures : public capture::CameraSource {
 public:
  explicit CountedPictures(int height = 6) : picture_(16, height) {}
  const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t /*begin_ps*/) override {
    if (fails) throw std::runtime_error("the disk is gone");
    for (std::size_t pixel = 0; pixel < picture_.pixels.size(); ++pixel)
      picture_.pixels[pixel] = static_cast<std::uint8_t>(7 * pixel + number);
    return picture_;
  }
  bool fails = false;

 private:
  kernels::GrayImage picture_;
};

// What the program did, one line for each access: its time and its result.
class LoggedBus {
 public:
  LoggedBus(host::HostBus& bus, const ComputerView& computer) : bus_(bus), computer_(computer) {}
  // `is_known`: not a word of a bank, which may differ at Fidelity::kTiming.
  std::uint32_t read(std::uint64_t address, bool is_known = true) {
    std::uint32_t value = 0;
    guarded("read", address, [&] { value = bus_.read(address); });
    if (is_known) text_ += " " + std::to_string(value);
    return value;
  }
  void write(std::uint64_t address, std::uint32_t value) {
    guarded("write", address, [&] { bus_.write(address, value); });
  }
  void wait_for_interrupt() {
    bus_.wait_for_interrupt();
    line("interrupt");
  }
  std::uint8_t* memory(std::uint64_t bytes) { return bus_.memory(kDevices.host_memory, bytes); }
  void line(const std::string& what) { text_ += '\n' + std::to_string(computer_.now_ps()) + " " + what; }
  const std::string& text() const { return text_; }

 private:
  void guarded(const char* what, std::uint64_t address, const std::function<void()>& access) {
    std::string error;
    try {
      access();
    } catch (const host::BusError& refused) {
      error = std::string(" refused: ") + refused.what();
    }
    line(what + (" " + std::to_string(address)) + error);
  }

  host::HostBus& bus_;
  const ComputerView& computer_;
  std::string text_;
};

BoardConfig fast_cameras() {
  BoardConfig board = testing::small_board();
  board.cameras.frame_rate_hz = 1000;
  return board;
}

// A computer with its program.
struct RunningComputer : host::Program {
  RunningComputer(Fidelity fidelity, std::function<void(LoggedBus&)> its_script,
                  const BoardConfig& board = fast_cameras())
      : script(std::move(its_script)) {
    if (fidelity == Fidelity::kCycle) {
      modules = std::make_unique<Computer>("computer", board, kMemoryBytes, *this, left, right, binder);
    } else {
      loop = std::make_unique<LoopComputer>(board, kMemoryBytes, left, right, fidelity);
    }
  }
  ComputerView& computer() { return modules ? static_cast<ComputerView&>(*modules) : *loop; }
  // Runs the program to its end, but for 1 s of simulated time at most.
  void finish() {
    if (loop) loop->run(*this, [this] { return loop->now_ps() < 1'000'000'000'000; });
    for (int ms = 0; modules && ms < 1000 && !has_ended; ++ms) sc_core::sc_start(1, sc_core::SC_MS);
    EXPECT_TRUE(has_ended);
  }

  void run(host::HostBus& bus) override {
    LoggedBus logged(bus, computer());
    script(logged);
    text = logged.text();
    has_ended = true;
  }

  std::function<void(LoggedBus&)> script;
  std::string text;  // of the program
  bool has_ended = false;
  CountedPictures left;
  CountedPictures right;
  test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
  std::unique_ptr<Computer> modules;
  std::unique_ptr<LoopComputer> loop;
};

std::string log_of(Fidelity fidelity, const std::function<void(LoggedBus&)>& script,
                   const BoardConfig& board) {
  return test::run_for_text([&] {
    RunningComputer running(fidelity, script, board);
    running.finish();
    const ComputerCounters counters = running.computer().counters();
    std::string text = running.text + "\nerrors: " + std::to_string(counters.bridge.errors) + " " +
                       std::to_string(counters.local_bus.errors);
    for (const ComputerCounters::Camera& camera : counters.cameras)
      text += " " + std::to_string(camera.capture.refused_accesses);
    return text;
  });
}

// A word of a bank, through aperture 3.
constexpr std::uint64_t kWindow = testing::aperture(3);

// The buffers of a frame are in these banks, from word 0 on.
void write_bases(LoggedBus& bus, const std::array<std::uint32_t, 5>& banks) {
  for (std::size_t buffer = 0; buffer < banks.size(); ++buffer)
    bus.write(core_register(testing::kBaseRegisters[buffer]), core::base(banks[buffer], 0));
}

// Does what software can do with the devices in an order drawn from a seed. Frames work in banks 0, 2, 4, 6
// and 7, with tables without valid entries; captures fill banks 1 and 3; everything else goes to words that
// no frame uses.
class RandomProgram {
 public:
  explicit RandomProgram(std::uint64_t seed) : random_(seed) {}

  void operator()(LoggedBus& bus) {
    begin(bus);
    for (int action = 0; action < 60; ++action) act(bus, random_.between(0, 8));
    while (expected_ != 0) handle_interrupt(bus);
    bus.read(kWindow, false);  // once the posted writes have reached the board, and are counted
    const std::uint8_t* const memory = bus.memory(kMemoryBytes);
    if (!only_times) bus.line("memory " + ::testing::PrintToString(std::vector<int>(memory, memory + 4096)));
  }
  bool only_times = false;  // the words of the banks are not logged

 private:
  static constexpr std::uint32_t kSpareWord = 500;

  void begin(LoggedBus& bus) {
    bus.write(kDevices.bridge_registers + bridge::kInterruptEnable, bridge::kAllInterrupts);
    bus.write(testing::page_register(3), kSpareWord);
    for (std::uint32_t side = 0; side < 2; ++side) {
      bus.write(testing::page_register(1 + side), (1 + 2 * side) << 26U);
      bus.write(kCaptures[side] + capture_map::kBufferAddress,
                static_cast<std::uint32_t>(testing::aperture(1 + side)));
    }
    write_bases(bus, {0, 2, 4, 6, 7});
  }

  void act(LoggedBus& bus, int action) {
    switch (action) {
      case 0:  // a pause
        for (int i = random_.between(1, 40); i > 0; --i) bus.read(kDevices.bridge_registers + bridge::kPage);
        break;
      case 1:
        access_any_register(bus);
        break;
      case 2:
        bus.write(testing::page_register(3),
                  static_cast<std::uint32_t>(random_.between(0, 7)) << 26U | kSpareWord);
        break;
      case 3:
        for (int i = random_.between(1, 20); i > 0; --i)
          bus.write(kWindow + 4 * static_cast<std::uint64_t>(random_.between(0, 15)),
                    static_cast<std::uint32_t>(i));
        break;
      case 4:
        bus.read(kWindow + 4 * static_cast<std::uint64_t>(random_.between(0, 15)), !only_times);
        break;
      case 5:
        start_core(bus);
        break;
      case 6:
        arm(bus);
        break;
      case 7:
        start_dma(bus);
        break;
      default:
        if (expected_ != 0) handle_interrupt(bus);
    }
  }

  // Some do not exist, some cannot be read, and some places cannot be written.
  void access_any_register(LoggedBus& bus) {
    const std::uint64_t word = 4 * static_cast<std::uint64_t>(random_.between(0, 16));
    const std::uint64_t devices[] = {kDevices.bridge_registers, kDevices.left_capture, kDevices.right_capture,
                                     core_register(0), kDevices.traffic_generator};
    bus.read(devices[random_.between(0, 4)] + word);
    const std::uint64_t refusing[] = {kDevices.right_capture + capture_map::kFrameNumberLow,
                                      core_register(core::kStatus),
                                      core_register(core::kEnd),
                                      kWindow + 4 * 2000,
                                      kDevices.traffic_generator,
                                      std::uint64_t{0xF000'0000}};
    bus.write(refusing[random_.between(0, 5)], 0);
  }
  void start_core(LoggedBus& bus) {
    if ((expected_ & kFrame) != 0) return;
    expected_ |= kFrame;
    bus.write(core_register(core::kControl), core::kControlStart);
  }
  void arm(LoggedBus& bus) {
    if ((expected_ & (kCapture | kCapture << 1U)) != 0) return;
    for (const unsigned side : {0U, 1U}) {
      expected_ |= kCapture << side;
      bus.write(kCaptures[side] + capture_map::kControl, capture_map::kControlArm);
    }
  }
  void start_dma(LoggedBus& bus) {
    const auto channel = static_cast<unsigned>(random_.between(0, 1));
    if ((expected_ & kDma << channel) != 0) return;
    expected_ |= kDma << channel;
    const auto bank = static_cast<std::uint32_t>(random_.between(0, 7));
    const auto words = static_cast<std::uint32_t>(random_.between(1, 100));
    const std::uint32_t descriptor[] = {1024U * (1 + channel), bank << 26U | kSpareWord,
                                        words | (random_.chance(50) ? bridge::kToPci : 0U), 0};
    std::memcpy(bus.memory(kMemoryBytes) + 4096 + 16 * channel, descriptor, sizeof descriptor);
    bus.write(testing::dma_register(channel, bridge::kDmaDescriptor), 4096 + 16 * channel);
    bus.write(testing::dma_register(channel, bridge::kDmaControl), 1);
  }
  void handle_interrupt(LoggedBus& bus) {
    bus.wait_for_interrupt();
    const std::uint32_t status = bus.read(kDevices.bridge_registers + bridge::kInterruptStatus);
    bus.write(kDevices.bridge_registers + bridge::kInterruptStatus, status);
    for (const unsigned channel : {0U, 1U}) {
      if ((status & bridge::kDmaDone << channel) != 0) expected_ &= ~(kDma << channel);
      if ((bus.read(kCaptures[channel] + capture_map::kStatus) & capture_map::kStatusDone) == 0) continue;
      bus.read(kCaptures[channel] + capture_map::kFrameNumberLow);
      bus.write(kCaptures[channel] + capture_map::kStatus, capture_map::kStatusDone);
      expected_ &= ~(kCapture << channel);
    }
    if ((status & bridge::kDoorbell) == 0) return;
    bus.read(core_register(core::kFrameCyclesLow));
    bus.write(core_register(core::kControl), core::kControlAcknowledge);
    expected_ &= ~kFrame;
  }

  static constexpr unsigned kFrame = 1U;
  static constexpr unsigned kCapture = 2U;  // left; right is the next bit
  static constexpr unsigned kDma = 8U;      // channel 0; channel 1 is the next bit
  test::SplitMix64 random_;
  unsigned expected_ = 0;  // interrupts that are to come
};

TEST(LoopComputer, EndsEachAccessAndRaisesEachInterruptAtTheTimesOfComputer) {
  sc_core::sc_report_handler::set_actions("/stereotlm/refused_access", sc_core::SC_DO_NOTHING);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    BoardConfig board = fast_cameras();
    if (seed % 2 == 1) board.pci.load = PciLoadConfig{8, 3, 1, 0.5};
    if (seed % 3 == 1) board.bridge.local_clock_mhz = 50;
    if (seed % 3 == 2) board.cameras.frame_rate_hz = 997.3;
    RandomProgram program(seed);
    const std::string expected = log_of(Fidelity::kCycle, program, board);
    EXPECT_GT(expected.size(), 5000U);
    EXPECT_NE(expected.find("refused"), std::string::npos);
    EXPECT_EQ(log_of(Fidelity::kFast, program, board), expected) << seed;
    program.only_times = true;
    EXPECT_EQ(log_of(Fidelity::kTiming, program, board), log_of(Fidelity::kCycle, program, board)) << seed;
  }
}

class LoopComputerErrors : public ::testing::Test {
 protected:
  // What the run of a computer throws whose program is `script`, and which `change` has changed.
  static std::string message(
      Fidelity fidelity, const std::function<void(LoggedBus&)>& script,
      const std::function<void(RunningComputer&)>& change = [](auto&) {}) {
    RunningComputer running(fidelity, script);
    change(running);
    try {
      running.finish();
    } catch (const std::exception& error) {
      EXPECT_FALSE(running.has_ended);
      return error.what();
    }
    return "";
  }
  static void start_core(LoggedBus& bus, std::uint32_t disparity_bank) {
    write_bases(bus, {0, 1, disparity_bank, 2, 3});
    bus.write(core_register(core::kControl), core::kControlStart);
  }
  static void wait_forever(LoggedBus& bus) {
    for (;;) {
      bus.wait_for_interrupt();
      bus.read(kDevices.bridge_registers + bridge::kPage);
    }
  }
  static void capture(LoggedBus& bus) {
    for (const std::uint64_t board : kCaptures)
      bus.write(board + capture_map::kControl, capture_map::kControlArm);
    wait_forever(bus);
  }
};

TEST_F(LoopComputerErrors, AreThrown) {
  EXPECT_EQ(message(Fidelity::kFast,
                    [](LoggedBus& bus) {
                      start_core(bus, 0);  // over the left image
                      wait_forever(bus);
                    }),
            "core: a frame that does not work directly on memory needs fidelity cycle");
  EXPECT_EQ(
      message(Fidelity::kTiming,
              [](LoggedBus& bus) {
                bus.write(testing::page_register(3), core::base(4, 5));
                start_core(bus, 4);
                bus.write(kWindow, 0);
                wait_forever(bus);
              }),
      "core: a burst of the local bus writes words 5..5 of bank number 4, where the running frame has its "
      "disparity: needs fidelity cycle");
  EXPECT_EQ(message(Fidelity::kFast, capture, [](RunningComputer& running) { running.right.fails = true; }),
            "the disk is gone");
  EXPECT_EQ(
      message(Fidelity::kFast, capture, [](RunningComputer& running) { running.left = CountedPictures(5); }),
      "picture of frame 1 = 16 x 5: must be 16 x 6");
}

TEST_F(LoopComputerErrors, OfTheProgramAreThrown) {
  EXPECT_EQ(message(Fidelity::kFast,
                    [](LoggedBus& bus) {
                      bus.write(kDevices.bridge_registers + bridge::kInterruptEnable, bridge::kAllInterrupts);
                      start_core(bus, 4);
                      for (;;) bus.wait_for_interrupt();
                    }),
            "wait_for_interrupt: the line is still asserted, and no register was accessed since it returned "
            "last");
  EXPECT_EQ(message(Fidelity::kFast, [](LoggedBus& bus) { bus.memory(kMemoryBytes + 1); }),
            "65537 bytes at 0x0: must be host memory");
}

TEST_F(LoopComputerErrors, EndsEarly) {
  RunningComputer running(Fidelity::kTiming, wait_forever);
  int calls = 0;
  running.loop->run(running, [&calls] { return ++calls < 4; });
  EXPECT_FALSE(running.has_ended);
  EXPECT_EQ(running.loop->now_ps(), 30'000'000'000U);
}

}  // namespace
}  // namespace stereotlm::platform
