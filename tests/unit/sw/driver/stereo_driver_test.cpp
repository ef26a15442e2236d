#include "sw/driver/stereo_driver.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/sw/driver/fake_machine.h"

namespace stereotlm::driver {
namespace {

struct Listener {
  void operator()(const DeliveredFrame& frame) { frames.push_back(frame.frame); }
  std::vector<std::uint64_t> frames;
};

// Pictures of one word, tables of four.
platform::BoardConfig small(std::size_t inputs, std::size_t outputs) {
  platform::BoardConfig board;
  board.image = {4, 1};
  board.allocation.left_image.assign(inputs, "bank0");
  board.allocation.right_image.assign(inputs, "bank1");
  board.allocation.disparity.assign(outputs, "bank2");
  return board;
}

// The same, with captures to host memory.
platform::BoardConfig small_by_host(std::size_t inputs, std::size_t outputs) {
  platform::BoardConfig board = small(inputs, outputs);
  board.capture.destination = platform::CaptureDestination::kHostMemory;
  return board;
}

const std::vector<std::uint32_t> kLeftTable = {1, 2, 3, 4};
const std::vector<std::uint32_t> kRightTable = {5, 6, 7, 8};
struct Failure {
  const char* name;
  std::function<void(FakeMachine&)> happens;
  std::string said;
  std::size_t most_frames;
  bool copies = false;  // pairs, by DMA, and no tables
};
void PrintTo(const Failure& failure, std::ostream* out) { *out << failure.name; }

class StereoDriverFailure : public testing::TestWithParam<Failure> {};

TEST_P(StereoDriverFailure, EndsTheRun) {
  const Failure& failure = GetParam();
  platform::BoardConfig board = failure.copies ? small_by_host(2, 2) : small(2, 2);
  if (failure.copies) board.allocation.left_lut = board.allocation.right_lut = std::nullopt;
  Listener listener;
  FakeMachine machine;
  failure.happens(machine);
  StereoDriver driver(board, 10, failure.copies ? nullptr : &kLeftTable,
                      failure.copies ? nullptr : &kRightTable, std::ref(listener));
  EXPECT_THAT([&] { driver.run(machine); },
              testing::ThrowsMessage<std::runtime_error>("stereo driver: " + failure.said));
  EXPECT_LE(listener.frames.size(), failure.most_frames);
}

INSTANTIATE_TEST_SUITE_P(
    StereoDriver, StereoDriverFailure,
    testing::Values(Failure{"words_lost", [](FakeMachine& machine) { machine.failing_capture = 3; },
                            "a capture board could not write its words", 3},
                    Failure{"frames_differ", [](FakeMachine& machine) { machine.diverging_capture = 3; },
                            "the capture boards have taken different frames", 3},
                    Failure{"core", [](FakeMachine& machine) { machine.failing_core = true; },
                            "the core has met an error", 0},
                    Failure{"posted_write", [](FakeMachine& machine) { machine.failing_write = true; },
                            "the board has refused a write", 0},
                    Failure{"upload", [](FakeMachine& machine) { machine.failing_channel = 0; },
                            "the tables could not be uploaded", 0},
                    Failure{"copy", [](FakeMachine& machine) { machine.failing_channel = 0; },
                            "DMA channel 0 has met an error", 0, true},
                    Failure{"read_back", [](FakeMachine& machine) { machine.failing_channel = 1; },
                            "DMA channel 1 has met an error", 0}),
    [](const auto& tested) { return tested.param.name; });

// Calls back before each wait of the driver.
class WatchedMachine : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  void wait_for_interrupt() override {
    on_wait();
    FakeMachine::wait_for_interrupt();
  }
  std::function<void()> on_wait = [] {};
};

TEST(StereoDriver, NamesTheWorkThatItWaitsFor) {
  Listener listener;
  WatchedMachine machine;
  StereoDriver driver(small_by_host(2, 2), 3, &kLeftTable, &kRightTable, std::ref(listener));
  EXPECT_EQ(driver.under_way(), "nothing");
  std::vector<std::string> texts;
  machine.on_wait = [&] { texts.push_back(driver.under_way()); };
  driver.run(machine);
  ASSERT_GE(texts.size(), 3U);
  EXPECT_EQ(texts[0], "the upload of the tables");
  EXPECT_EQ(texts[1], "capture 0");
  EXPECT_THAT(texts, testing::Contains("capture 1, copy of pair 0"));
  EXPECT_THAT(texts, testing::Contains(testing::HasSubstr("core with frame 2")));
  EXPECT_THAT(texts, testing::Contains(testing::HasSubstr("read-back of frame 0")));
}

// Lines such as "copy 1: copy 0 (copy), capture 1 (pair)".
class Starts : public platform::DriverObserver {
 public:
  void starts(platform::Activity activity, const std::vector<platform::Awaited>& awaited) override {
    constexpr std::array<const char*, platform::kActivities> kNames = {"capture", "copy", "frame",
                                                                       "read-back"};
    const auto index = static_cast<std::size_t>(activity);
    std::string line = fmt::format("{} {}:", kNames[index], begun_[index]++);
    for (const platform::Awaited& each : awaited)
      line += fmt::format(" {} {} ({})", kNames[static_cast<std::size_t>(each.activity)], each.number,
                          each.reason);
    lines.push_back(line);
  }
  std::vector<std::string> lines;

 private:
  std::array<std::uint64_t, platform::kActivities> begun_{};
};

TEST(StereoDriver, SaysWhatEachOfItsStartsHasWaitedFor) {
  const auto lines_of = [](const platform::BoardConfig& board) {
    Listener listener;
    FakeMachine machine;
    Starts starts;
    StereoDriver driver(board, 4, &kLeftTable, &kRightTable, std::ref(listener));
    driver.set_observer(starts);
    driver.run(machine);
    return starts.lines;
  };
  EXPECT_THAT(lines_of(small(2, 1)),
              testing::IsSupersetOf({"capture 0:", "capture 1: capture 0 (capture)",
                                     "capture 3: capture 2 (capture) frame 1 (input_buffer)",
                                     "frame 0: capture 0 (pair)",
                                     "frame 2: frame 1 (core) capture 2 (pair) read-back 1 (output_buffer)",
                                     "read-back 2: read-back 1 (read_back) frame 2 (frame)"}));
  EXPECT_THAT(lines_of(small_by_host(2, 3)),
              testing::IsSupersetOf({"capture 3: capture 2 (capture) copy 0 (ring)",
                                     "copy 2: copy 1 (copy) capture 2 (pair) frame 0 (input_buffer)",
                                     "frame 3: frame 2 (core) copy 3 (pair) read-back 0 (output_buffer)"}));
}

TEST(StereoDriver, UsesJustTheHostMemoryThatItAnnounces) {
  for (const bool to_host : {false, true}) {
    const platform::BoardConfig board = to_host ? small_by_host(2, 2) : small(2, 2);
    Listener listener;
    FakeMachine enough(host_memory_bytes(board));
    StereoDriver driver(board, 8, &kLeftTable, &kRightTable, std::ref(listener));
    EXPECT_NO_THROW(driver.run(enough));
    FakeMachine short_of_a_byte(host_memory_bytes(board) - 1);
    StereoDriver other(board, 8, &kLeftTable, &kRightTable, std::ref(listener));
    EXPECT_THROW(other.run(short_of_a_byte), std::out_of_range);
  }
}

// Records the addresses of its writes, and the memory of the last chain of each DMA channel.
class RecordingMachine : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) override {
    last_ = {address, address + bytes};
    return FakeMachine::memory(address, bytes);
  }
  void write(std::uint64_t address, std::uint32_t value) override {
    const std::uint64_t bridge = platform::DeviceMap{}.bridge_registers;
    ++writes[address - bridge];
    for (unsigned channel = 0; channel < 2; ++channel) {
      const std::uint64_t registers = bridge + channel * pci::bridge::kChannelStride;
      if (address == registers + pci::bridge::kDmaDescriptor) {
        EXPECT_EQ(value, last_.first);
        chains[channel] = last_;
      }
    }
    FakeMachine::write(address, value);
  }
  std::map<std::uint64_t, int> writes;                              // [register of the bridge]
  std::array<std::pair<std::uint64_t, std::uint64_t>, 2> chains{};  // [channel]: first byte, end

 private:
  std::pair<std::uint64_t, std::uint64_t> last_;
};

// Pictures of `height` rows of a word, in stripes over four banks, without tables.
platform::BoardConfig striped(int height) {
  platform::BoardConfig board;
  board.image = {4, height};
  const platform::BufferBanks stripe(std::vector<std::string>{"bank0", "bank1", "bank2", "bank3"});
  board.allocation.left_image = board.allocation.right_image = board.allocation.disparity = {stripe, stripe};
  board.allocation.left_lut = board.allocation.right_lut = std::nullopt;
  return board;
}

TEST(StereoDriver, TheChainsOfBothDmaChannelsHaveMemoryOfTheirOwn) {
  platform::BoardConfig board = striped(512);
  board.capture.destination = platform::CaptureDestination::kHostMemory;
  Listener listener;
  RecordingMachine machine(host_memory_bytes(board));
  StereoDriver(board, 3, nullptr, nullptr, std::ref(listener)).run(machine);
  const auto [copy, read_back] = machine.chains;
  EXPECT_EQ(copy.second - copy.first, 2 * 512 * 16U) << "a descriptor for each row of a pair";
  EXPECT_EQ(read_back.second - read_back.first, 4 * 16U) << "one for each part of a result";
  EXPECT_LE(copy.second, read_back.first);
}

TEST(StereoDriver, WritesThePagesOfPartsWithRowsAlone) {
  for (const auto& [height, parts] : {std::pair(1, 1), std::pair(3, 3), std::pair(5, 4)}) {
    Listener listener;
    RecordingMachine machine;
    StereoDriver(striped(height), 3, nullptr, nullptr, std::ref(listener)).run(machine);
    const int captures = machine.writes[pci::bridge::kPage];
    EXPECT_GE(captures, 3);
    EXPECT_EQ(machine.writes[pci::bridge::kPage + 4], captures);
    EXPECT_EQ(machine.writes[pci::bridge::kNextPage], (parts - 1) * captures) << height;
    EXPECT_EQ(machine.writes[pci::bridge::kNextPage + 4], (parts - 1) * captures) << height;
  }
}

TEST(StereoDriver, RefusesATableOfAnotherSize) {
  Listener listener;
  const platform::BoardConfig board = small(2, 1);
  const std::vector<std::uint32_t> short_table = {1, 2, 3};
  EXPECT_THROW(StereoDriver(board, 1, &short_table, &kRightTable, std::ref(listener)), std::invalid_argument);
  EXPECT_THROW(StereoDriver(board, 1, &kLeftTable, nullptr, std::ref(listener)), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::driver
