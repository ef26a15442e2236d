// FastCore without its module and without the kernel: frames that work directly on memory, hazards, the end of
// a frame, and the horizon. The tests of StereoCore compare its figures with those of stepped frames.
#include "models/fpga/fast_core.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/kernels/rectification_table.h"
#include "models/memory/crossbar_address.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;

// A core of 8 x 6 pixels with six banks of 64 words, as in stereo_core_bench.h, and a local bus with the core's
// clock. The test is the board, its memory and the master of the local bus.
class FastCoreTest : public testing::Test,
                     public FastCore::Board,
                     public LocalBusControl::Core,
                     public LocalBusMasterIf,
                     public memory::DirectBanks {
 protected:
  enum Bank : std::uint32_t { kLeft, kRight, kResult, kLeftTable, kRightTable, kSpare, kBankCount };
  static constexpr std::uint64_t kPs = 25'000;  // a clock
  static constexpr std::size_t kWords = 64;     // of a bank
  static constexpr std::uint32_t kImageWords = 12;
  static constexpr std::uint32_t kTableWords = 48;
  static constexpr std::uint32_t kOld = 0x4D4D'4D4D;  // in the buffer of the disparities before a frame
  static constexpr std::uint64_t kFirstWord = 3;      // clocks from the beginning of a burst to its request

  FastCoreTest() {
    bus.bind(*this);
    for (auto& bank : banks) bank.resize(kWords);
    const auto entries = kernels::identity_table(8, 6).entries;
    for (const Bank table : {kLeftTable, kRightTable})
      std::copy(entries.begin(), entries.end(), banks[table].begin());
    banks[kResult].assign(kWords, kOld);
    start.bases = {registers::base(kLeftTable, 0), registers::base(kRightTable, 0), registers::base(kLeft, 0),
                   registers::base(kRight, 0), registers::base(kResult, 0)};
  }
  static CoreConfig config() {
    CoreConfig config = small_core(8, 6);
    config.pipeline_latency_cycles = 5;
    return config;
  }

  bool start_frame(std::uint64_t cycle) {
    start.time_ps = cycle * kPs;
    next_ps = start.time_ps;
    return core.start_frame(cycle, start);
  }
  // Calls the core whenever it is due, up to `end_ps`.
  void run_to(std::uint64_t end_ps) {
    for (;;) {
      const std::uint64_t due_ps = std::min(next_ps, request_ps);
      if (due_ps > end_ps) return;
      if (due_ps == request_ps) request_ps = kNever;
      now_ps = std::max(now_ps, due_ps);
      ++calls;
      next_ps = core.advance(now_ps);
    }
  }
  void run_to_end() { run_to(kNever - 1); }
  void begin_burst(std::uint64_t time_ps, bool write, std::uint64_t bank, std::uint64_t word,
                   std::size_t words) {
    run_to(time_ps - 1);
    now_ps = time_ps;
    burst.assign(words, 0);
    bus.begin_burst(time_ps, {write, crossbar_address(bank, 0) + 4 * word,
                              reinterpret_cast<unsigned char*>(burst.data()), words});
  }
  // The cycle of the last write of a frame without contention that begins in cycle 0.
  std::uint64_t last_write() const {
    const FrameGeometry& geometry = frames.control().geometry();
    return 4 + geometry.slots + geometry.drain_cycles;
  }
  std::uint64_t frame_cycles() const { return last_write() + 1 + 5; }

  // FastCore::Board
  std::uint64_t horizon_ps() const override { return horizon(now_ps); }
  DirectFrame::Memory direct_memory(const DirectFrame::Buffers& buffers,
                                    const kernels::JointOffsets&) override {
    DirectFrame::Memory memory;
    for (const Side side : kSides) {
      memory.tables[index_of(side)].entries =
          reinterpret_cast<const std::uint32_t*>(bytes_of(buffers[lut_port(side)]));
      memory.images[index_of(side)] = bytes_of(buffers[pixel_port(side)]);
    }
    disparities = bytes_of(buffers[kResultPort]);
    memory.disparities = disparities;
    return memory;
  }
  std::uint8_t* direct_disparities() override { return disparities; }
  void frame_finished(const DirectFrame&) override {
    finished_ps.push_back(now_ps);
    EXPECT_EQ(finished_ps.size(), ended_ps.size() + 1);
  }
  void frame_ended(bool failed) override {
    ended_ps.push_back(now_ps);
    ended_failed.push_back(failed);
  }
  void failed(const std::string& why) override { failures.push_back(why); }
  void stalled(std::uint64_t cycles) override { ADD_FAILURE() << "stalled for " << cycles; }
  // LocalBusControl::Core
  void route(const HostRoute& route) override {
    core.route(route);
    request_ps = bus.word_waits() ? bus.request_ps() : kNever;
  }
  bool access_bank(std::uint64_t at_ps, bool write, std::uint64_t address, std::uint32_t& word) override {
    words_ps.push_back({now_ps, at_ps});
    std::uint32_t& stored = banks[memory::bank_of_address(address)].at(address % crossbar_address(1, 0) / 4);
    (write ? stored : word) = write ? word : stored;
    return true;
  }
  bool access_register(std::uint64_t, bool, std::uint64_t, std::uint32_t&) override { return false; }
  // LocalBusMasterIf
  void end_burst_at(std::uint64_t end_ps, bool ok) override {
    EXPECT_TRUE(ok);
    burst_ends_ps.push_back(end_ps);
  }
  // memory::DirectBanks
  unsigned char* direct(std::uint64_t address, std::uint64_t bytes) override {
    return bytes_of({address, address + bytes});
  }
  void changes(std::uint64_t, std::uint64_t) override {}
  void count_direct(std::size_t, std::uint64_t) override {}
  void allow_access(memory::Port) override {}

  std::uint8_t* bytes_of(const AddressRange& range) {
    const std::uint64_t first = range.first % crossbar_address(1, 0);
    if (is_closed || first + (range.end - range.first) > 4 * kWords) return nullptr;
    return reinterpret_cast<std::uint8_t*>(banks[memory::bank_of_address(range.first)].data()) + first;
  }

  std::function<std::uint64_t(std::uint64_t)> horizon = [](std::uint64_t now) { return now; };
  std::array<std::vector<std::uint32_t>, kBankCount> banks;
  bool is_closed = false;  // no direct access
  FrameStart start;
  std::uint8_t* disparities = nullptr;
  std::uint64_t now_ps = 0;
  std::uint64_t next_ps = kNever;
  std::uint64_t request_ps = kNever;  // a burst begins to request then
  int calls = 0;
  std::vector<std::uint64_t> finished_ps;
  std::vector<std::uint64_t> ended_ps;
  std::vector<bool> ended_failed;
  std::vector<std::string> failures;
  std::vector<std::uint32_t> burst;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> words_ps;  // words that were accessed: called, at
  std::vector<std::uint64_t> burst_ends_ps;

  std::vector<memory::SsramBankConfig> bank_configs{kBankCount, memory::SsramBankConfig{kWords}};
  memory::Arbitration arbitration{core_arbiter(), bank_configs};
  FrameRun frames{config(), bank_configs, arbitration, UINT64_MAX};
  LocalBusControl bus{{40, {}}, kBankCount, *this};
  Clock clock{40};
  HostPort host_port{bus, *this, arbitration, frames, clock};
  FastCore core{config(), true, frames, host_port, bus, clock, *this};
};

// How far the board lets the core run ahead of the present.
struct Horizon {
  const char* name;
  std::uint64_t ahead_ps;
};
class FastCoreHorizon : public FastCoreTest, public testing::WithParamInterface<Horizon> {
 protected:
  FastCoreHorizon() {
    horizon = [ahead_ps = GetParam().ahead_ps](std::uint64_t now) {
      return ahead_ps == kNever ? kNever : now + ahead_ps;
    };
  }
};

TEST_P(FastCoreHorizon, WritesTheDisparitiesEarlyButNotBeforeIt) {
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    const std::uint64_t first = 10'000 * frame + 7;
    banks[kResult].assign(kWords, kOld);
    EXPECT_TRUE(start_frame(first));
    EXPECT_EQ(banks[kResult][0], kOld);
    const std::uint64_t write_ps = (first + last_write()) * kPs;
    while (finished_ps.size() == frame) {
      EXPECT_EQ(banks[kResult][0], kOld);
      run_to(next_ps);
    }
    EXPECT_NE(banks[kResult][0], kOld);
    EXPECT_EQ(banks[kResult][kImageWords], kOld);
    if (GetParam().ahead_ps == kNever) {
      EXPECT_EQ(finished_ps[frame], first * kPs);
    } else {
      EXPECT_GT(finished_ps[frame] + GetParam().ahead_ps, write_ps);
      EXPECT_LE(finished_ps[frame], write_ps + kPs);
    }
    run_to_end();
    ASSERT_EQ(ended_ps.size(), frame + 1);
    EXPECT_EQ(ended_ps[frame], (first + frame_cycles()) * kPs);
    EXPECT_EQ(frames.frame_cycles().back(), frame_cycles());
    EXPECT_EQ(next_ps, kNever);
  }
  EXPECT_TRUE(failures.empty());
  EXPECT_LE(calls, 2 * 4);
}

INSTANTIATE_TEST_SUITE_P(FastCore, FastCoreHorizon,
                         testing::Values(Horizon{"now", 0}, Horizon{"a_ps", 1},
                                         Horizon{"ten_cycles", 250'000}, Horizon{"never", kNever}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Words of a bank that no frame uses. Another master of the registers may start a frame.
TEST_F(FastCoreTest, ServesTheWordsOfABurstUpToItsHorizon) {
  std::uint64_t begin_ps = 0;
  for (const std::uint64_t ahead_ps : {std::uint64_t{0}, 2 * kPs, kNever / 2}) {
    SCOPED_TRACE(ahead_ps);
    horizon = [ahead_ps](std::uint64_t now) { return now + ahead_ps; };
    words_ps.clear();
    calls = 0;
    begin_ps += 1000 * kPs;
    begin_burst(begin_ps, true, kSpare, 0, 8);
    run_to_end();
    ASSERT_EQ(words_ps.size(), 8U);
    for (std::size_t word = 0; word < 8; ++word) {
      const auto& [called_ps, at_ps] = words_ps[word];
      EXPECT_EQ(at_ps, begin_ps + (kFirstWord + word) * kPs);
      // Before the horizon, or in a cycle that has begun.
      EXPECT_TRUE(at_ps < called_ps + ahead_ps || at_ps < called_ps) << word;
    }
    EXPECT_EQ(burst_ends_ps.back(), begin_ps + (kFirstWord + 8) * kPs);
    EXPECT_EQ(calls == 1, ahead_ps == kNever / 2);
  }
}

// A frame that must be stepped, and the same frame without what is special.
TEST_F(FastCoreTest, StartsNoFrameThatCannotWorkDirectlyOnMemory) {
  struct Special {
    const char* name;
    std::function<void()> change;
    std::function<void()> restore;
  };
  const auto base = [this](memory::Port port, std::uint32_t value) {
    return [this, port, value] { start.bases[port] = value; };
  };
  const auto left_entry = [this](std::uint32_t entry) {
    return [this, entry] { banks[kLeftTable][5] = entry; };
  };
  const Special specials[] = {
      {"no direct access", [this] { is_closed = true; }, [this] { is_closed = false; }},
      {"an image behind the end of the bank", base(pixel_port(Side::kRight), registers::base(kRight, 60)),
       base(pixel_port(Side::kRight), registers::base(kRight, 0))},
      {"disparities over the left image", base(kResultPort, registers::base(kLeft, kImageWords - 1)),
       base(kResultPort, registers::base(kResult, 0))},
      {"an entry outside the image", left_entry(kernels::make_entry(8, 0)),
       left_entry(kernels::make_entry(5, 0))},
  };
  std::uint64_t cycle = 0;
  for (const Special& special : specials) {
    SCOPED_TRACE(special.name);
    special.change();
    EXPECT_FALSE(start_frame(cycle));
    EXPECT_FALSE(frames.is_running());
    special.restore();
    EXPECT_TRUE(start_frame(cycle));
    run_to_end();
    cycle += 10'000;
  }
  EXPECT_EQ(ended_ps.size(), std::size(specials));
  EXPECT_TRUE(failures.empty());
}

// A burst of 20 words that has begun before the frame, with its first word in cycle 3.
TEST_F(FastCoreTest, StartsNoFrameBesideTheRestOfABurstThatIsAHazard) {
  struct Rest {
    Bank bank;
    std::uint64_t word;
    std::uint64_t frame;  // its first cycle
    bool starts;
  };
  std::uint64_t clock_now = 10;
  for (const Rest& rest : {Rest{kLeft, 0, 3 + 11, false}, Rest{kLeft, 0, 3 + 12, true},
                           Rest{kSpare, 0, 5, true}, Rest{kLeft, kImageWords, 5, true}}) {
    begin_burst(clock_now * kPs, true, rest.bank, rest.word, 20);
    run_to((clock_now + rest.frame) * kPs - 1);
    now_ps = (clock_now + rest.frame) * kPs;
    EXPECT_EQ(start_frame(clock_now + rest.frame), rest.starts) << rest.bank << ", " << rest.frame;
    run_to_end();
    clock_now += 10'000;
  }
  EXPECT_TRUE(failures.empty());
}

// A burst in cycle 10 of a frame, and what it is to the frame.
struct BurstInFrame {
  const char* name;
  bool write;
  std::uint32_t bank;
  std::uint64_t word;
  std::size_t words;
  const char* hazard;  // empty: none
};
class FastCoreHazards : public FastCoreTest, public testing::WithParamInterface<BurstInFrame> {
 public:
  static std::vector<BurstInFrame> bursts() {
    return {
        {"last_word_of_the_left_image", true, kLeft, 11, 1,
         "writes words 11..11 of bank number 0, where the running frame has its left_image"},
        {"right_image", true, kRight, 3, 8,
         "writes words 3..10 of bank number 1, where the running frame has its right_image"},
        {"table", true, kRightTable, 40, 20,
         "writes words 40..59 of bank number 4, where the running frame has its right_lut"},
        {"write_of_disparities", true, kResult, 0, 1,
         "writes words 0..0 of bank number 2, where the running frame has its disparity"},
        {"read_of_disparities", false, kResult, 11, 2,
         "reads words 11..12 of bank number 2, where the running frame has its disparity"},
        {"read_of_an_image", false, kLeft, 0, 12, ""},
        {"read_of_a_table", false, kLeftTable, 0, 48, ""},
        {"write_behind_an_image", true, kLeft, kImageWords, 4, ""},
        {"write_behind_a_table", true, kLeftTable, kTableWords, 2, ""},
        {"read_behind_the_disparities", false, kResult, kImageWords, 1, ""},
        {"another_bank", true, kSpare, 0, 20, ""},
    };
  }
};

TEST_P(FastCoreHazards, AreBurstsThatWouldObserveThatTheFrameWorksDirectly) {
  const BurstInFrame& tested = GetParam();
  const std::string text = tested.hazard;
  const bool is_hazard = !text.empty();
  for (const bool only_master : {false, true}) {
    host_port.set_only_master(only_master);
    const std::uint64_t first = only_master ? 20'000 : 0;
    failures.clear();
    EXPECT_TRUE(start_frame(first));
    begin_burst((first + 10) * kPs, tested.write, tested.bank, tested.word, tested.words);
    EXPECT_EQ(failures.size(), is_hazard ? 1U : 0U);  // at once
    if (is_hazard) {
      EXPECT_EQ(failures[0], "a burst of the local bus " + text + ": needs fidelity cycle");
    }
    run_to_end();
    EXPECT_EQ(ended_failed.back(), is_hazard);
    EXPECT_TRUE(start_frame(first + 10'000));  // the next frame is not affected
    run_to_end();
    EXPECT_FALSE(ended_failed.back());
  }
  EXPECT_EQ(ended_ps.size(), 4U);
  EXPECT_EQ(burst_ends_ps.size(), 2U);
}

INSTANTIATE_TEST_SUITE_P(FastCore, FastCoreHazards, testing::ValuesIn(FastCoreHazards::bursts()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(FastCoreTest, TakesABurstForNoHazardBetweenTwoFrames) {
  host_port.set_only_master(true);
  for (const std::uint64_t first : {0U, 10'000U}) {
    EXPECT_TRUE(start_frame(first));
    run_to((first + 9'000) * kPs);
    begin_burst((first + 9'000) * kPs, false, kResult, 0, kImageWords);
    run_to_end();
    EXPECT_EQ(burst,
              std::vector<std::uint32_t>(banks[kResult].begin(), banks[kResult].begin() + kImageWords));
  }
  EXPECT_TRUE(failures.empty());
}

// Reads of the left image in every cycle from cycle `10` on: the reader of the left pixels waits for them.
TEST_F(FastCoreTest, EndsAFrameLaterByTheCyclesThatABurstTakesFromIt) {
  EXPECT_TRUE(start_frame(0));
  begin_burst(10 * kPs, false, kLeft, 0, 12);
  run_to_end();
  EXPECT_EQ(ended_ps, std::vector<std::uint64_t>{(frame_cycles() + 12) * kPs});
  EXPECT_EQ(burst_ends_ps, std::vector<std::uint64_t>{(10 + kFirstWord + 12 - 1 + 2 + 1) * kPs});
}

TEST_F(FastCoreTest, FailsAFrameWhoseDisparitiesCannotBeWrittenDirectlyAnyMore) {
  EXPECT_TRUE(start_frame(0));
  disparities = nullptr;
  run_to_end();
  EXPECT_EQ(failures,
            std::vector<std::string>{"direct access to the disparities was taken back within a frame"});
  EXPECT_EQ(finished_ps.size(), 1U);
  EXPECT_EQ(ended_failed, std::vector<bool>{true});
  EXPECT_EQ(banks[kResult][0], kOld);
}

}  // namespace
}  // namespace stereotlm::fpga
