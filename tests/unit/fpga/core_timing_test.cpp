// Running ahead against stepping, on random cores, banks and tables.
#include "models/fpga/core_timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/fpga/random_core.h"
#include "tests/unit/support/random_memory.h"

namespace stereotlm::fpga {
namespace {

using memory::Port;

constexpr std::uint64_t kNever = UINT64_MAX;

// A burst of the local bus, which begins to ask in a cycle counted from the frame's first, or later if the
// one before it has not ended.
struct Burst {
  std::uint64_t cycle = 0;
  std::size_t bank = 0;
  bool write = false;
  int words = 1;
  std::uint64_t waits = 0;  // cycles, routed, before it asks
};

struct Setting {
  CoreConfig core;
  memory::ArbiterConfig arbiter;
  std::vector<memory::SsramBankConfig> banks;
  std::array<std::size_t, memory::kPortCount> bank_of{};
  std::vector<std::uint32_t> left_entries;
  std::vector<std::uint32_t> right_entries;
  int frames = 1;
  std::size_t most_groups = TransitionCache::kMost;
};

Setting random_setting(test::SplitMix64& random) {
  Setting setting;
  setting.core = random_core(random, 64);
  setting.arbiter = test::random_arbiter(random);
  const int banks = random.between(1, 6);
  for (int bank = 0; bank < banks; ++bank) setting.banks.push_back(test::random_bank(random));
  for (std::size_t& bank : setting.bank_of) bank = static_cast<std::size_t>(random.between(0, banks - 1));
  setting.left_entries = random_entries(random, setting.core);
  setting.right_entries = random_entries(random, setting.core);
  setting.frames = random.between(1, 3);
  if (random.chance(30)) setting.most_groups = static_cast<std::size_t>(random.between(1, 16));
  return setting;
}

// A core with its arbiters, frame after frame.
class Timing {
 public:
  enum class Way { kStepped, kAhead };

  Timing(const Setting& setting, Way way, bool records_rows = false)
      : setting_(setting),
        way_(way),
        arbitration_(setting.arbiter, setting.banks),
        timing_(setting.core, arbitration_, setting.most_groups),
        left_(FrameGeometry(setting.core)),
        right_(FrameGeometry(setting.core)) {
    if (setting.core.left_table) left_.set_entries(setting.left_entries.data());
    if (setting.core.right_table) right_.set_entries(setting.right_entries.data());
    if (records_rows) timing_.rows().turn_on();
  }

  void start(std::uint64_t cycle) {
    first_cycle_ = cycle_ = cycle;
    const auto route = [this](Port port, bool exists, bool write) {
      const std::size_t bank = setting_.bank_of[memory::index_of(port)];
      if (exists) arbitration_.route(port, bank, write);
      return memory::read_latency_cycles(setting_.banks[bank].kind);
    };
    FrameLatencies latencies;
    latencies.left_lut = route(Port::kLeftLut, setting_.core.left_table, false);
    latencies.right_lut = route(Port::kRightLut, setting_.core.right_table, false);
    latencies.left_image = route(Port::kLeftPixel, true, false);
    latencies.right_image = route(Port::kRightPixel, true, false);
    route(Port::kResult, true, true);
    if (way_ == Way::kAhead) {
      timing_.start_frame(latencies, left_, right_);
    } else {
      timing_.start_frame(latencies);
    }
    arbitration_.begin_counting(cycle);
  }
  bool done() const { return timing_.control().frame_done(); }
  std::uint64_t cycle() const { return cycle_; }
  std::uint64_t earliest_last_write() const { return timing_.earliest_last_write(cycle_); }
  bool step(bool host_requests = false) {
    const memory::PortMask granted =
        way_ == Way::kAhead
            ? timing_.step(cycle_, host_requests)
            : timing_.step(cycle_, host_requests, [this](const auto&, memory::PortMask grants) {
                const auto valid = [grants](Port lut, const LaneControl& lane, const AccessPattern& pattern) {
                  const SlotCursor& slot = lane.next_slot();
                  return (grants & memory::mask_of(lut)) != 0 &&
                         pattern.entry_valid(slot.column(), slot.row());
                };
                return EntriesRead{valid(Port::kLeftLut, timing_.control().left(), left_),
                                   valid(Port::kRightLut, timing_.control().right(), right_)};
              });
    ++cycle_;
    return (granted & memory::mask_of(Port::kHost)) != 0;
  }
  void step_to(std::uint64_t end) {
    while (cycle_ < end && !done()) step();
  }
  void run_to(std::uint64_t end) { cycle_ = timing_.run_ahead(cycle_, end); }
  // The words of a burst, until it ends or the frame.
  void serve(const Burst& burst) {
    if (done()) return;
    timing_.host_route_changes();
    arbitration_.route(Port::kHost, burst.bank, burst.write);
    way_ == Way::kAhead ? run_to(cycle_ + burst.waits) : step_to(cycle_ + burst.waits);
    for (int words = 0; words < burst.words && !done();) words += int{step(true)};
    timing_.host_route_changes();
    arbitration_.unroute(Port::kHost);
  }
  void finish() {
    timing_.end_frame();
    arbitration_.end_counting(cycle_);
  }
  std::uint64_t first_cycle() const { return first_cycle_; }
  RowProfile rows() const { return timing_.rows().profile(first_cycle_); }

  // All that is counted, and where it is.
  std::string figures() const {
    std::ostringstream text;
    text << "next cycle " << cycle_ << '\n';
    for (std::size_t port = 0; port < memory::kPortCount; ++port) {
      const PortCycles& cycles = timing_.control().port_cycles(static_cast<Port>(port));
      text << memory::kPortNames[port] << ": granted " << cycles.granted() << ", stalled " << cycles.stalled()
           << ", passed " << cycles.passed() << ", idle " << cycles.idle() << ", blocked " << cycles.blocked()
           << ", starved " << cycles.starved() << '\n';
    }
    for (const memory::BankArbiter& arbiter : arbitration_.arbiters()) {
      const memory::ArbiterStats stats = arbiter.stats();
      text << "bank: reads " << stats.reads << ", writes " << stats.writes << ", turnaround "
           << stats.turnaround_cycles << ", idle " << stats.idle_cycles << ", contended "
           << stats.contended_cycles << ", uncounted " << arbiter.uncounted_accesses() << "; blame";
      for (const auto& victim : stats.blame) {
        for (const std::uint64_t cycles : victim) text << ' ' << cycles;
      }
      text << '\n';
    }
    text << "consumed " << timing_.control().left().consumed() << ' ' << timing_.control().right().consumed()
         << ", most queued " << timing_.control().result().most_queued() << '\n';
    for (const RowEnd& row : rows()) {
      text << "row whole after " << row.cycles << ", stalls";
      for (const std::uint64_t cycles : row.stalls) text << ' ' << cycles;
      text << '\n';
    }
    return text.str();
  }

 private:
  const Setting& setting_;
  Way way_;
  memory::Arbitration arbitration_;
  CoreTiming timing_;
  AccessPattern left_;
  AccessPattern right_;
  std::uint64_t cycle_ = 0;
  std::uint64_t first_cycle_ = 0;
};

// Two of the same setting, one stepped and one run ahead, frame after frame: `frame(random, stepped, ahead)`
// takes both to the end of each.
template <typename Frame>
void expect_equal_in_random_settings(std::uint64_t settings, const Frame& frame, bool record_rows = false) {
  for (std::uint64_t seed = 0; seed < settings; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const Setting setting = random_setting(random);
    Timing stepped(setting, Timing::Way::kStepped, record_rows);
    Timing ahead(setting, Timing::Way::kAhead, record_rows);
    std::uint64_t cycle = static_cast<std::uint64_t>(random.between(0, 100));
    for (int number = 0; number < setting.frames; ++number) {
      stepped.start(cycle);
      ahead.start(cycle);
      frame(random, setting, stepped, ahead);
      stepped.finish();
      ahead.finish();
      ASSERT_TRUE(ahead.done());
      ASSERT_EQ(ahead.figures(), stepped.figures()) << "frame " << number;
      cycle = stepped.cycle() + static_cast<std::uint64_t>(random.mostly_small(0, 3, 1000));
    }
  }
}

TEST(CoreTiming, RunsAheadToWhatItsStepsCount) {
  expect_equal_in_random_settings(400, [](auto&, const Setting&, Timing& stepped, Timing& ahead) {
    stepped.step_to(kNever);
    ahead.run_to(kNever);
  });
}

TEST(CoreTiming, StopsAnywhereAndGoesOn) {
  expect_equal_in_random_settings(200, [](auto& random, const Setting&, Timing& stepped, Timing& ahead) {
    while (!ahead.done()) {
      const std::uint64_t end = ahead.cycle() + static_cast<std::uint64_t>(random.mostly_small(1, 300, 5000));
      ahead.run_to(end);
      EXPECT_LE(ahead.cycle(), end);
      stepped.step_to(end);
      EXPECT_EQ(ahead.cycle(), stepped.cycle());
    }
  });
}

TEST(CoreTiming, IsStoppedInTheMiddleWithTheCountsOfTheSteps) {
  for (std::uint64_t seed = 1000; seed < 1200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const Setting setting = random_setting(random);
    Timing stepped(setting, Timing::Way::kStepped);
    Timing ahead(setting, Timing::Way::kAhead);
    const auto end = static_cast<std::uint64_t>(random.between(1, 3000));
    for (Timing* timing : {&stepped, &ahead}) timing->start(0);
    ahead.run_to(end);
    stepped.step_to(end);
    for (Timing* timing : {&stepped, &ahead}) timing->finish();
    ASSERT_EQ(ahead.figures(), stepped.figures());
  }
}

// Both to the end of a frame, with bursts of the host in between.
void run_beside_host(test::SplitMix64& random, const Setting& setting, Timing& stepped, Timing& ahead) {
  for (int bursts = random.mostly_small(0, 6, 100); bursts > 0; --bursts) {
    Burst burst;
    burst.cycle = ahead.cycle() + static_cast<std::uint64_t>(random.mostly_small(0, 500, 5000));
    burst.bank = static_cast<std::size_t>(random.between(0, static_cast<int>(setting.banks.size()) - 1));
    burst.write = random.chance(50);
    burst.words = random.mostly_small(1, 8, 100);
    if (random.chance(30)) burst.waits = static_cast<std::uint64_t>(random.between(1, 500));
    stepped.step_to(burst.cycle);
    ahead.run_to(burst.cycle);
    stepped.serve(burst);
    ahead.serve(burst);
  }
  stepped.step_to(kNever);
  ahead.run_to(kNever);
}

TEST(CoreTiming, IsSteppedForTheHostInBetween) { expect_equal_in_random_settings(300, run_beside_host); }

TEST(CoreTiming, RecordsTheRowsOfItsSteps) { expect_equal_in_random_settings(400, run_beside_host, true); }

// Row y is whole with the write behind column (y + 1) * W + C - 1, n cycles each from cycle 4 on.
TEST(CoreTiming, RecordsRowsWhereThePapersBoardHasThem) {
  Setting setting;
  setting.core.filter.reset();
  setting.banks.resize(6);
  for (std::size_t port = 0; port < memory::kPortCount; ++port) setting.bank_of[port] = port;
  setting.left_entries = setting.right_entries = kernels::identity_table(640, 480).entries;
  Timing timing(setting, Timing::Way::kAhead, true);
  for (const std::uint64_t first_cycle : {100U, 10'000'000U}) {
    timing.start(first_cycle);
    timing.run_to(kNever);
    const RowProfile rows = timing.rows();
    ASSERT_EQ(rows.size(), 480U);
    for (std::uint64_t row = 0; row < 480; ++row) {
      EXPECT_EQ(rows[row], (RowEnd{4 + 7 * (640 * (row + 1) + 79 + 3) + 1, {}})) << row;
    }
    EXPECT_EQ(rows.back().cycles + 16, 2'150'995U);  // contract section 2
    EXPECT_EQ(timing.cycle(), first_cycle + rows.back().cycles);
    timing.finish();
  }
}

// The left table beside the left image (contract section 2): half of the columns' reads come too late.
TEST(CoreTiming, RecordsInWhichRowsAPortIsStalled) {
  Setting setting;
  setting.core.filter.reset();
  setting.banks.resize(6);
  for (std::size_t port = 0; port < memory::kPortCount; ++port) setting.bank_of[port] = port;
  setting.bank_of[memory::index_of(Port::kLeftLut)] = setting.bank_of[memory::index_of(Port::kLeftPixel)];
  setting.left_entries = setting.right_entries = kernels::identity_table(640, 480).entries;
  Timing timing(setting, Timing::Way::kAhead, true);
  for (const std::uint64_t first_cycle : {0U, 10'000'000U}) {
    timing.start(first_cycle);
    timing.run_to(kNever);
    const RowProfile rows = timing.rows();
    ASSERT_EQ(rows.size(), 480U);
    EXPECT_EQ(rows.back().cycles + 16, 4'288'597U);
    EXPECT_EQ(rows.back().stalls, (std::array<std::uint64_t, kCorePortCount>{2'137'602, 0, 0, 0, 0}));
    for (std::size_t row = 10; row < 400; ++row) {
      EXPECT_EQ(rows[row].cycles - rows[row - 1].cycles, 2U * 640 * 7) << row;
      EXPECT_EQ(rows[row].stalls[0] - rows[row - 1].stalls[0], 640U * 7) << row;
    }
    timing.finish();
  }
}

TEST(CoreTiming, RecordsNoRowsUnasked) {
  Setting setting;
  setting.core.width = 16;
  setting.core.height = 5;
  setting.banks.resize(6);
  setting.left_entries = setting.right_entries = kernels::identity_table(16, 5).entries;
  Timing timing(setting, Timing::Way::kAhead);
  timing.start(0);
  timing.run_to(kNever);
  EXPECT_TRUE(timing.done());
  EXPECT_TRUE(timing.rows().empty());
}

TEST(CoreTiming, NeverNamesALastWriteLaterThanItIs) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const Setting setting = random_setting(random);
    Timing timing(setting, Timing::Way::kAhead);
    timing.start(0);
    std::vector<std::uint64_t> earliest;
    while (!timing.done()) {
      earliest.push_back(timing.earliest_last_write());
      timing.step();
    }
    const std::uint64_t last_write = timing.cycle() - 1;
    ASSERT_LE(*std::max_element(earliest.begin(), earliest.end()), last_write);
    ASSERT_EQ(earliest.back(), last_write);
  }
}

TEST(CoreTiming, NamesTheLastWriteFromTheFirstSlotConsumedOnWhereNothingContends) {
  Setting setting;
  setting.core.width = 16;
  setting.core.height = 5;
  setting.core.window = 3;
  setting.core.disparities = 4;
  setting.core.filter.reset();
  setting.banks.resize(6);
  for (std::size_t port = 0; port < memory::kPortCount; ++port) setting.bank_of[port] = port;
  setting.left_entries = setting.right_entries = kernels::identity_table(16, 5).entries;
  Timing timing(setting, Timing::Way::kAhead);
  timing.start(100);
  timing.step_to(100 + 4);  // the latencies of table and image
  const std::uint64_t last_write = timing.earliest_last_write();
  timing.run_to(kNever);
  EXPECT_EQ(timing.cycle(), last_write + 1);
}

}  // namespace
}  // namespace stereotlm::fpga
