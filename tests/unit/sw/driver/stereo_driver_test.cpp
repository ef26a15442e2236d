#include "sw/driver/stereo_driver.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/unit/sw/driver/fake_machine.h"

namespace stereotlm::driver {
namespace {

class Listener : public FrameListener {
 public:
  void frame_delivered(const DeliveredFrame& frame) override { frames.push_back(frame.frame); }
  std::vector<std::uint64_t> frames;
};

constexpr std::uint32_t word_of_bank(std::uint32_t bank) { return bank << 26U; }

// Pictures of one word, tables of four; each buffer has its own bank.
DriverConfig small(std::size_t inputs, std::size_t outputs, std::uint64_t frames) {
  DriverConfig config;
  config.width = 4;
  config.height = 1;
  config.frames = frames;
  for (std::uint32_t i = 0; i < inputs; ++i) {
    config.buffers.left_images.push_back(word_of_bank(i));
    config.buffers.right_images.push_back(word_of_bank(10 + i));
  }
  for (std::uint32_t i = 0; i < outputs; ++i) config.buffers.disparities.push_back(word_of_bank(20 + i));
  config.buffers.left_lut = word_of_bank(30);
  config.buffers.right_lut = word_of_bank(31) + 5;
  return config;
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
  DriverConfig config = small(2, 2, 10);
  config.capture_to_host = failure.copies;
  if (failure.copies) config.buffers.left_lut = config.buffers.right_lut = std::nullopt;
  Listener listener;
  FakeMachine machine;
  failure.happens(machine);
  StereoDriver driver(config, failure.copies ? nullptr : &kLeftTable, failure.copies ? nullptr : &kRightTable,
                      listener);
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

// Calls back before each wait and each write of the driver.
class WatchedMachine : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  void wait_for_interrupt() override {
    on_wait();
    FakeMachine::wait_for_interrupt();
  }
  void write(std::uint64_t address, std::uint32_t value) override {
    on_write();
    FakeMachine::write(address, value);
  }
  std::function<void()> on_wait = [] {};
  std::function<void()> on_write = [] {};
};

TEST(StereoDriver, NamesTheWorkThatItWaitsFor) {
  Listener listener;
  WatchedMachine machine;
  DriverConfig config = small(2, 2, 3);
  config.capture_to_host = true;
  StereoDriver driver(config, &kLeftTable, &kRightTable, listener);
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
  const auto lines_of = [](const DriverConfig& config) {
    Listener listener;
    FakeMachine machine;
    Starts starts;
    StereoDriver driver(config, &kLeftTable, &kRightTable, listener);
    driver.set_observer(starts);
    driver.run(machine);
    return starts.lines;
  };
  EXPECT_THAT(lines_of(small(2, 1, 4)),
              testing::IsSupersetOf({"capture 0:", "capture 1: capture 0 (capture)",
                                     "capture 3: capture 2 (capture) frame 1 (input_buffer)",
                                     "frame 0: capture 0 (pair)",
                                     "frame 2: frame 1 (core) capture 2 (pair) read-back 1 (output_buffer)",
                                     "read-back 2: read-back 1 (read_back) frame 2 (frame)"}));
  DriverConfig ring = small(2, 3, 4);
  ring.capture_to_host = true;
  ring.host_frames = 3;
  EXPECT_THAT(lines_of(ring),
              testing::IsSupersetOf({"capture 3: capture 2 (capture) copy 0 (ring)",
                                     "copy 2: copy 1 (copy) capture 2 (pair) frame 0 (input_buffer)",
                                     "frame 3: frame 2 (core) copy 3 (pair) read-back 0 (output_buffer)"}));
}

// It delivers the frames that the core has begun, and no others.
TEST(StereoDriver, CanBeToldToStartNoMoreDuringAnyAccess) {
  for (int moment = 20; moment < 120; ++moment) {
    SCOPED_TRACE(moment);
    Listener listener;
    WatchedMachine machine;
    StereoDriver driver(small(2, 2, 1'000'000), &kLeftTable, &kRightTable, listener);
    std::uint64_t started = 0;
    int writes = 0;
    machine.on_write = [&] {
      if (++writes != moment) return;
      started = driver.frames_started();
      driver.start_no_more();
    };
    driver.run(machine);
    EXPECT_EQ(machine.core_starts, started);
    EXPECT_EQ(listener.frames.size(), started);
  }
}

TEST(StereoDriver, UsesJustTheHostMemoryThatItAnnounces) {
  for (const bool to_host : {false, true}) {
    DriverConfig config = small(2, 2, 8);
    config.capture_to_host = to_host;
    Listener listener;
    FakeMachine enough(host_memory_bytes(config));
    StereoDriver driver(config, &kLeftTable, &kRightTable, listener);
    EXPECT_NO_THROW(driver.run(enough));
    FakeMachine short_of_a_byte(host_memory_bytes(config) - 1);
    StereoDriver other(config, &kLeftTable, &kRightTable, listener);
    EXPECT_THROW(other.run(short_of_a_byte), std::out_of_range);
  }
}

TEST(StereoDriver, RefusesATableOfAnotherSize) {
  Listener listener;
  const DriverConfig config = small(2, 1, 1);
  const std::vector<std::uint32_t> short_table = {1, 2, 3};
  EXPECT_THROW(StereoDriver(config, &short_table, &kRightTable, listener), std::invalid_argument);
  EXPECT_THROW(StereoDriver(config, &kLeftTable, nullptr, listener), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::driver
