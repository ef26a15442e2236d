// Running ahead compared with stepping, on random cores, banks and tables.
#include "models/fpga/fast_forward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/frame_run.h"
#include "tests/unit/fpga/core_figures.h"
#include "tests/unit/fpga/random_core.h"
#include "tests/unit/support/random_memory.h"

namespace stereotlm::fpga {
namespace {

constexpr std::uint64_t kNever = UINT64_MAX;

// A burst of the local bus. It begins to request in a cycle of the clock, or later if the burst before it has
// not ended.
struct Burst {
  std::uint64_t cycle = 0;
  std::size_t bank = 0;
  bool write = false;
  int words = 1;
  std::uint64_t waits = 0;  // cycles, routed, before it requests
};

struct Setting {
  CoreConfig core;
  memory::ArbiterConfig arbiter = core_arbiter();
  std::vector<memory::SsramBankConfig> banks;
  FrameBases bases{};
  std::vector<std::uint32_t> left_entries;
  std::vector<std::uint32_t> right_entries;
  int frames = 1;
  std::size_t most_groups = TransitionCache::kMost;
};

Setting random_setting(test::SplitMix64& random) {
  Setting setting;
  setting.core = random_core(random, 64);
  setting.arbiter = test::random_arbiter(random);
  for (int banks = random.between(1, 6); banks > 0; --banks)
    setting.banks.push_back(test::random_bank(random));
  for (std::uint32_t& base : setting.bases) {
    const int banks = static_cast<int>(setting.banks.size());
    base = registers::base(static_cast<std::uint32_t>(random.between(0, banks - 1)), 0);
  }
  setting.left_entries = random_entries(random, setting.core);
  setting.right_entries = random_entries(random, setting.core);
  setting.frames = random.between(1, 3);
  if (random.chance(30)) setting.most_groups = static_cast<std::size_t>(random.between(1, 16));
  draw_units(random, setting.core);
  draw_rows(random, setting.core);
  return setting;
}

// The board of the paper without filter, or a smaller image: a bank for each port, and every entry valid.
Setting bank_for_each_port(int width, int height) {
  Setting setting;
  setting.core.width = width;
  setting.core.height = height;
  setting.core.filter.reset();
  setting.banks.resize(6);
  for (std::uint32_t port = 0; port < kCorePortCount; ++port) setting.bases[port] = registers::base(port, 0);
  setting.left_entries = setting.right_entries = kernels::identity_table(width, height).entries;
  return setting;
}

// Joint tables in one bank, pictures and disparities in another, and a word cache.
Setting two_banks() {
  Setting setting = bank_for_each_port(640, 480);
  setting.core.joint_tables = true;
  setting.core.pixel_cache = PixelCache::kWord;
  setting.banks.resize(2);
  setting.bases.fill(registers::base(1, 0));
  setting.bases[0] = registers::base(0, 0);
  return setting;
}

// A core with its arbiters, frame after frame.
class Core {
 public:
  enum class Way { kStepped, kAhead };

  Core(const Setting& setting, Way way, bool records_rows = false)
      : setting_(setting),
        way_(way),
        arbitration_(setting.arbiter, setting.banks),
        frames_(setting.core, setting.banks, arbitration_, kNever, setting.most_groups) {
    if (setting.core.left_table) patterns_[0].set_entries(setting.left_entries.data());
    if (setting.core.right_table) patterns_[1].set_entries(setting.right_entries.data());
    if (records_rows) frames_.record_rows();
  }

  void start(std::uint64_t cycle) {
    if (way_ == Way::kAhead) {
      frames_.start_direct(cycle, setting_.bases, patterns_);
    } else {
      frames_.start_stepped(cycle, setting_.bases);
    }
  }
  bool done() const { return frames_.control().frame_done(); }
  std::uint64_t cycle() const { return frames_.cycle(); }
  std::uint64_t earliest_last_write() const { return frames_.earliest_last_write(); }
  std::uint64_t work() const { return frames_.control().work(); }
  // One cycle. True if the host is granted.
  bool step(bool host_requests = false) {
    const memory::PortMask granted =
        way_ == Way::kAhead
            ? frames_.step(host_requests)
            : frames_.step(host_requests, [this](const auto& /*decision*/, memory::PortMask grants) {
                return PixelNeeds{needs_pixel(Side::kLeft, grants), needs_pixel(Side::kRight, grants)};
              });
    return (granted & memory::mask_of(kHostPort)) != 0;
  }
  // Takes the frame up to a cycle, or to its end.
  void advance(std::uint64_t end) {
    if (way_ == Way::kAhead) frames_.run_ahead(end);
    while (cycle() < end && !done()) step();
  }
  // The words of a burst, up to the end of the burst or the frame.
  void serve(const Burst& burst) {
    if (done()) return;
    frames_.host_route_changes();
    arbitration_.route(kHostPort, burst.bank, burst.write);
    advance(cycle() + burst.waits);
    for (int words = 0; words < burst.words && !done();) {
      if (!step(true)) continue;
      ++words;
      last_grant_ = cycle() - 1;
    }
    frames_.host_route_changes();
    arbitration_.unroute(kHostPort);
  }
  // The words of a burst of a bus in step with the core, up to the end of the burst or the frame: each
  // requests in the cycle after a grant. Returns the cycle of the last grant.
  std::uint64_t serve_in_step(const Burst& burst) {
    if (way_ == Way::kStepped) {
      advance(burst.cycle);
      serve({burst.cycle, burst.bank, burst.write, burst.words});
      return last_grant_;
    }
    auto left = static_cast<std::size_t>(burst.words);
    for (std::uint64_t first = burst.cycle; left > 0 && !done();) {
      const FastForward::Served served = frames_.serve_host({burst.bank, burst.write}, first, left);
      left -= served.words;
      if (served.words == 0) continue;
      last_grant_ = served.last_cycle;
      first = last_grant_ + 1;
    }
    return last_grant_;
  }
  bool expects_known_burst(bool write) { return frames_.expects_known_burst(write); }
  void finish() {
    frames_.finish();
    frames_.end();
    for (const RowProfile& frame : frames_.take_rows()) rows_ = frame;
  }

  std::uint64_t skipped_cycles() const { return frames_.skipped_cycles(); }
  // Of the last frame.
  const RowProfile& rows() const { return rows_; }
  std::string figures() const {
    CoreFigures figures(frames_, arbitration_.arbiters());
    figures.add(rows_);
    return figures.text();
  }

 private:
  bool needs_pixel(Side side, memory::PortMask grants) const {
    const SlotCursor& slot = frames_.control().lane(side).next_slot();
    return (grants & memory::mask_of(frames_.control().table_port(side))) != 0 &&
           patterns_[index_of(side)].needs_pixel(slot.column(), slot.row());
  }

  const Setting& setting_;
  Way way_;
  memory::Arbitration arbitration_;
  FrameRun frames_;
  AccessPatterns patterns_{AccessPattern(FrameGeometry(setting_.core), setting_.core.pixel_cache),
                           AccessPattern(FrameGeometry(setting_.core), setting_.core.pixel_cache)};
  RowProfile rows_;
  std::uint64_t last_grant_ = 0;  // of the host
};

// Two cores of the same random setting, one stepped and one run ahead, frame after frame.
// `frame(random, setting, stepped, ahead)` takes both to the end of each frame, or as far as it likes.
template <typename Frame>
void expect_equal_figures(std::uint64_t settings, const Frame& frame, bool records_rows = false) {
  for (std::uint64_t seed = 0; seed < settings; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const Setting setting = random_setting(random);
    Core stepped(setting, Core::Way::kStepped, records_rows);
    Core ahead(setting, Core::Way::kAhead, records_rows);
    auto cycle = static_cast<std::uint64_t>(random.between(0, 100));
    for (int number = 0; number < setting.frames; ++number) {
      stepped.start(cycle);
      ahead.start(cycle);
      frame(random, setting, stepped, ahead);
      stepped.finish();
      ahead.finish();
      ASSERT_EQ(ahead.cycle(), stepped.cycle());
      ASSERT_EQ(ahead.figures(), stepped.figures()) << "frame " << number;
      ASSERT_EQ(ahead.rows().empty(), !records_rows);
      cycle = stepped.cycle() + static_cast<std::uint64_t>(random.mostly_small(0, 3, 1000));
    }
  }
}

void run_to_the_end(Core& stepped, Core& ahead) {
  stepped.advance(kNever);
  ahead.advance(kNever);
  ASSERT_TRUE(ahead.done());
}

TEST(FastForward, StopsInAnyCycleAndResumes) {
  expect_equal_figures(200, [](auto& random, auto&, Core& stepped, Core& ahead) {
    while (!ahead.done()) {
      const std::uint64_t end = ahead.cycle() + static_cast<std::uint64_t>(random.mostly_small(1, 300, 5000));
      ahead.advance(end);
      EXPECT_LE(ahead.cycle(), end);
      stepped.advance(end);
      EXPECT_EQ(ahead.cycle(), stepped.cycle());
    }
  });
}

TEST(FastForward, HasTheCountsOfTheStepsInTheMiddleOfAFrame) {
  expect_equal_figures(200, [](auto& random, auto&, Core& stepped, Core& ahead) {
    const std::uint64_t end = ahead.cycle() + static_cast<std::uint64_t>(random.between(1, 3000));
    ahead.advance(end);
    stepped.advance(end);
  });
}

// Takes both to the end of a frame, with bursts of the host in between.
void run_beside_host(test::SplitMix64& random, const Setting& setting, Core& stepped, Core& ahead) {
  for (int bursts = random.mostly_small(0, 6, 100); bursts > 0; --bursts) {
    Burst burst;
    burst.cycle = ahead.cycle() + static_cast<std::uint64_t>(random.mostly_small(0, 500, 5000));
    burst.bank = static_cast<std::size_t>(random.between(0, static_cast<int>(setting.banks.size()) - 1));
    burst.write = random.chance(50);
    burst.words = random.mostly_small(1, 8, 100);
    if (random.chance(30)) burst.waits = static_cast<std::uint64_t>(random.between(1, 500));
    for (Core* core : {&stepped, &ahead}) {
      core->advance(burst.cycle);
      core->serve(burst);
    }
  }
  run_to_the_end(stepped, ahead);
}

// As before, with many bursts like each other: soon most of them are known. A few come word by word.
void run_beside_bursts_in_step(test::SplitMix64& random, const Setting& setting, Core& stepped, Core& ahead) {
  const auto draw_bank = [&] { return random.between(0, static_cast<int>(setting.banks.size()) - 1); };
  const int bank = draw_bank();
  const bool write = random.chance(50);
  const int words = random.mostly_small(1, 40, 300);
  const int pause = random.mostly_small(1, 200, 1000);
  const int others = random.chance(50) ? 0 : random.between(1, 30);  // percent
  Burst burst;
  burst.cycle = ahead.cycle() + static_cast<std::uint64_t>(random.mostly_small(0, 200, 1000));
  while (!stepped.done()) {
    burst.bank = static_cast<std::size_t>(random.chance(others) ? draw_bank() : bank);
    burst.write = random.chance(others) ? random.chance(50) : write;
    burst.words = random.chance(others) ? random.between(1, 40) : words;
    std::uint64_t last_grant = 0;
    if (random.chance(others / 4)) {
      for (Core* core : {&stepped, &ahead}) {
        core->advance(burst.cycle);
        core->serve(burst);
      }
      last_grant = stepped.cycle();
    } else {
      last_grant = stepped.serve_in_step(burst);
      ASSERT_EQ(ahead.serve_in_step(burst), last_grant);
    }
    burst.cycle = std::max(last_grant, burst.cycle) + 1;
    if (random.chance(others)) {  // somebody looks
      burst.cycle += static_cast<std::uint64_t>(random.between(0, 100));
      stepped.advance(burst.cycle);
      ahead.advance(burst.cycle);
      ASSERT_EQ(ahead.cycle(), stepped.cycle());
    }
    burst.cycle += static_cast<std::uint64_t>(random.chance(others) ? random.between(0, 300) : pause);
  }
  run_to_the_end(stepped, ahead);
}

TEST(FastForward, GrantsABurstInTheCyclesOfItsSteps) { expect_equal_figures(400, run_beside_bursts_in_step); }

TEST(FastForward, RecordsTheRowsOfItsStepsBesideBursts) {
  expect_equal_figures(400, run_beside_bursts_in_step, true);
}

TEST(FastForward, CountsWhatItsStepsCountBesideTheHost) { expect_equal_figures(300, run_beside_host); }

TEST(FastForward, RecordsTheRowsOfItsSteps) { expect_equal_figures(400, run_beside_host, true); }

// The left table beside the left image (contract section 2): half of the columns' reads come too late.
TEST(FastForward, RecordsInWhichRowsAPortIsStalled) {
  Setting setting = bank_for_each_port(640, 480);
  setting.bases[0] = setting.bases[2];
  Core core(setting, Core::Way::kAhead, true);
  for (const std::uint64_t first_cycle : {100U, 10'000'000U}) {
    core.start(first_cycle);
    core.advance(kNever);
    core.finish();
    const RowProfile& rows = core.rows();
    ASSERT_EQ(rows.size(), 480U);
    EXPECT_EQ(core.cycle(), first_cycle + rows.back().cycles);
    EXPECT_EQ(rows.back().cycles + 16, 4'288'597U);
    EXPECT_EQ(rows.back().stalls, (std::array<std::uint64_t, kCorePortCount>{2'137'602, 0, 0, 0, 0}));
    for (std::size_t row = 10; row < 400; ++row) {
      EXPECT_EQ(rows[row].cycles - rows[row - 1].cycles, 2U * 640 * 7) << row;
      EXPECT_EQ(rows[row].stalls[0] - rows[row - 1].stalls[0], 640U * 7) << row;
    }
  }
}

// The number of cycles that are stepped in each of three frames.
std::vector<std::uint64_t> stepped_cycles(const Setting& setting) {
  Core core(setting, Core::Way::kAhead);
  std::vector<std::uint64_t> stepped;
  for (int frame = 0; frame < 3; ++frame) {
    const std::uint64_t begin = core.cycle() - core.skipped_cycles();
    core.start(core.cycle());
    core.advance(kNever);
    stepped.push_back(core.cycle() - core.skipped_cycles() - begin);
    core.finish();
  }
  return stepped;
}

// A frame has 2.15 million cycles. Those around its first row, its last row and its end are always stepped.
TEST(FastForward, StepsFewCyclesOfAFrameOnceItsTransitionsAreRecorded) {
  const std::vector<std::uint64_t> identity = stepped_cycles(two_banks());
  EXPECT_LT(identity[0], 1000U);
  Setting slanted = two_banks();
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      slanted.left_entries[place_of(slanted.core, column, row)] = kernels::make_entry(
          std::min(639, column + column / 100 + row / 70), std::min(479, row + column / 80));
    }
  }
  const std::vector<std::uint64_t> irregular = stepped_cycles(slanted);
  EXPECT_LT(irregular[0], 50'000U);
  for (const auto& stepped : {identity, irregular}) {
    EXPECT_LT(stepped[1], 1000U);
    EXPECT_EQ(stepped[2], stepped[1]);
  }
}

// A group of four columns has 31,496 cycles, so that no whole one fits between two stops.
TEST(FastForward, StepsFewCyclesOfASlotThatTheMatcherTakesLongFor) {
  Setting setting = bank_for_each_port(64, 8);
  setting.core.window = 31;
  setting.core.disparities = 254;
  setting.core.units = 1;
  Core stepped(setting, Core::Way::kStepped);
  Core ahead(setting, Core::Way::kAhead);
  for (Core* core : {&stepped, &ahead}) core->start(0);
  while (!ahead.done()) {
    ahead.advance(ahead.cycle() + 10'000);
    stepped.advance(ahead.cycle());
    ASSERT_EQ(ahead.figures(), stepped.figures());
  }
  EXPECT_LT(20 * (ahead.cycle() - ahead.skipped_cycles()), ahead.cycle());
}

// The number of cycles that are stepped in each of two frames beside bursts of as many words to a bank. They
// begin in many phases of a group.
std::vector<std::uint64_t> stepped_beside_bursts(std::size_t bank, int words) {
  Setting setting = bank_for_each_port(640, 480);
  setting.arbiter.policy = "round_robin";
  Core core(setting, Core::Way::kAhead);
  std::vector<std::uint64_t> stepped;
  for (int frame = 0; frame < 2; ++frame) {
    const std::uint64_t begin = core.cycle() - core.skipped_cycles();
    core.start(core.cycle());
    for (std::uint64_t first = core.cycle() + 10'000; !core.done();)
      first = core.serve_in_step({first, bank, true, words}) + 901;
    core.advance(kNever);
    stepped.push_back(core.cycle() - core.skipped_cycles() - begin);
    core.finish();
  }
  return stepped;
}

TEST(FastForward, StepsFewCyclesBesideBurstsOnceTheirGroupsAreRecorded) {
  const std::vector<std::uint64_t> with_table = stepped_beside_bursts(0, 32);
  EXPECT_LT(with_table[0], 20'000U);
  EXPECT_LT(with_table[1], 2000U);
  // But for the last ones, the groups of a long burst are alike.
  const std::vector<std::uint64_t> with_results = stepped_beside_bursts(4, 1000);
  EXPECT_LT(with_results[0], 10'000U);
  EXPECT_LT(with_results[1], 2000U);
}

// As before, with two bursts of 32 words every `pause` cycles, to two banks and in both directions: the
// second begins `gap` cycles after the first has ended.
std::vector<std::uint64_t> stepped_beside_pairs_of_bursts(std::uint64_t pause, std::uint64_t gap) {
  const Setting setting = bank_for_each_port(640, 480);
  Core core(setting, Core::Way::kAhead);
  std::vector<std::uint64_t> stepped;
  for (int frame = 0; frame < 3; ++frame) {
    const std::uint64_t begin = core.cycle() - core.skipped_cycles();
    core.start(core.cycle());
    for (std::uint64_t first = core.cycle() + 10'000; !core.done(); first += pause) {
      const std::uint64_t last = core.serve_in_step({first, 0, true, 32});
      core.serve_in_step({last + 1 + gap, 3, false, 32});
    }
    core.advance(kNever);
    stepped.push_back(core.cycle() - core.skipped_cycles() - begin);
    core.finish();
  }
  return stepped;
}

TEST(FastForward, StepsFewCyclesBesideBurstsThatShareAGroup) {
  for (const std::uint64_t gap : {0U, 1U, 13U, 27U, 28U, 29U}) {
    const std::vector<std::uint64_t> stepped = stepped_beside_pairs_of_bursts(301, gap);
    EXPECT_LT(stepped[0], 100'000U) << gap;
    EXPECT_LT(stepped[2], 4000U) << gap;
  }
}

// The first group that is not known begins more than HostRequests::kMostCycles before the burst.
TEST(FastForward, RecordsTheGroupsFarBeforeABurst) {
  const Setting setting = bank_for_each_port(640, 480);
  Core core(setting, Core::Way::kAhead);
  core.start(0);
  core.serve_in_step({100, 0, true, 1});
  const std::uint64_t begin = core.cycle() - core.skipped_cycles();
  EXPECT_EQ(core.serve_in_step({1'000'000, 0, true, 1}), 1'000'000U);
  EXPECT_LT(core.cycle() - core.skipped_cycles() - begin, 2000U);
}

// The pixel ports have banks of their own, so that their accesses need not be known until a burst goes there.
TEST(FastForward, ForgetsABurstWithTheEndOfItsFrame) {
  Setting setting = bank_for_each_port(640, 480);
  test::SplitMix64 random(1);
  for (std::uint32_t& entry : setting.left_entries) {
    if (random.chance(50)) entry = 0;
  }
  Core core(setting, Core::Way::kAhead);
  const auto stepped = [&](const std::vector<std::size_t>& banks) {
    const std::uint64_t begin = core.cycle() - core.skipped_cycles();
    core.start(core.cycle());
    for (const std::size_t bank : banks) core.serve_in_step({core.cycle() + 10'000, bank, true, 32});
    core.advance(kNever);
    const std::uint64_t cycles = core.cycle() - core.skipped_cycles() - begin;
    core.finish();
    return cycles;
  };
  const std::uint64_t alone = stepped({});
  EXPECT_LT(alone, 2000U);
  EXPECT_LT(stepped({0, 0, 3, 3}), 4000U);  // the left table and the right picture
  EXPECT_GT(stepped({2, 2}), 20'000U);
  EXPECT_LE(stepped({}), alone);
}

// A burst ends in the group in which the next one begins.
TEST(FastForward, GrantsTwoBurstsOfAGroup) {
  const Setting setting = bank_for_each_port(64, 24);
  for (std::uint64_t pause = 1; pause < 30; ++pause) {
    Core stepped(setting, Core::Way::kStepped);
    Core ahead(setting, Core::Way::kAhead);
    for (int frame = 0; frame < 3; ++frame) {
      stepped.start(stepped.cycle());
      ahead.start(ahead.cycle());
      for (Burst burst{stepped.cycle() + 500, 0, true, 3}; !stepped.done(); burst.cycle += 900) {
        for (int number = 0; number < 2; ++number) {
          const std::uint64_t last_grant = stepped.serve_in_step(burst);
          ASSERT_EQ(ahead.serve_in_step(burst), last_grant);
          burst.cycle = last_grant + pause;
        }
      }
      stepped.finish();
      ahead.finish();
      ASSERT_EQ(ahead.figures(), stepped.figures()) << pause;
    }
  }
}

// After a burst that is known, the core is still in the state before it. Whatever is called next takes the core
// to the last grant: a step, a burst that comes word by word, or the end of the frame.
TEST(FastForward, IsTakenToTheLastGrantByAnyCall) {
  const Setting setting = bank_for_each_port(64, 24);
  Core stepped(setting, Core::Way::kStepped);
  Core ahead(setting, Core::Way::kAhead);
  for (int frame = 0; frame < 6; ++frame) {
    stepped.start(stepped.cycle());
    ahead.start(ahead.cycle());
    Burst burst{stepped.cycle() + 500, 0, true, 3};
    for (int number = 0; !stepped.done(); ++number) {
      const std::uint64_t last_grant = stepped.serve_in_step(burst);
      ASSERT_EQ(ahead.serve_in_step(burst), last_grant);
      ASSERT_EQ(ahead.cycle(), stepped.cycle());
      if (number % 3 == 1) {
        ahead.step();
        stepped.step();
      } else if (number % 3 == 2) {
        for (Core* core : {&stepped, &ahead}) core->serve({0, 1, true, 2});
      }
      ASSERT_EQ(ahead.cycle(), stepped.cycle());
      burst.cycle = stepped.cycle() + 600;
    }
    ahead.advance(kNever);
    stepped.finish();
    ahead.finish();
    ASSERT_EQ(ahead.figures(), stepped.figures()) << frame;
  }
}

TEST(FastForward, RefusesAFrameBeforeTheLastOneIsSettled) {
  const Setting setting = bank_for_each_port(64, 24);
  Core core(setting, Core::Way::kAhead);
  for (int frame = 0; frame < 2; ++frame) {
    core.start(core.cycle());
    const std::uint64_t first = core.cycle();
    for (std::uint64_t number = 1; number < 4; ++number)
      core.serve_in_step({first + 700 * number, 0, true, 3});
    if (frame == 1) break;
    core.advance(kNever);
    core.finish();
  }
  EXPECT_THROW(core.start(core.cycle()), std::logic_error);
}

// A burst that begins with a group of the drain is known. One that begins after the last group comes in the
// same state, but there the matcher has nothing to do. A slot takes 16 cycles.
TEST(FastForward, FollowsNoBurstBeyondTheLastGroupOfTheDrain) {
  Setting setting = bank_for_each_port(64, 24);
  setting.core.disparities = 16;
  setting.core.units = 1;
  Core alone(setting, Core::Way::kStepped);
  alone.start(0);
  alone.advance(kNever);
  const std::uint64_t last_write = alone.cycle() - 1;
  const std::uint64_t group = 4 * 7 * 16;
  Core stepped(setting, Core::Way::kStepped);
  Core ahead(setting, Core::Way::kAhead);
  for (int frame = 0; frame < 3; ++frame) {
    const std::uint64_t start = stepped.cycle();
    stepped.start(start);
    ahead.start(start);
    for (std::uint64_t groups = 3; groups <= 3; --groups) {
      const Burst burst{start + last_write - groups * group, 4, true, 5};
      ASSERT_EQ(ahead.serve_in_step(burst), stepped.serve_in_step(burst));
    }
    stepped.advance(kNever);
    ahead.advance(kNever);
    EXPECT_EQ(stepped.cycle(), start + last_write + 1 + 5);
    EXPECT_EQ(ahead.work(), stepped.work());
    stepped.finish();
    ahead.finish();
    ASSERT_EQ(ahead.figures(), stepped.figures());
  }
}

// The entries have no order, and so the accesses of no two groups are alike. Until a burst has been found
// unknown often enough, it is looked for.
TEST(FastForward, DoesNotExpectToKnowBurstsThatNeverComeAgain) {
  Setting setting = two_banks();
  test::SplitMix64 random(1);
  for (std::uint32_t& entry : setting.left_entries) {
    if (random.chance(50)) entry = 0;
  }
  Core core(setting, Core::Way::kAhead);
  core.start(0);
  std::uint64_t cycle = 10'000;
  for (int burst = 0; burst < 300; ++burst) cycle = core.serve_in_step({cycle, 0, true, 32}) + 901;
  EXPECT_FALSE(core.expects_known_burst(true));
  EXPECT_TRUE(core.expects_known_burst(false));
  for (int burst = 2; burst < 2048; ++burst) EXPECT_FALSE(core.expects_known_burst(true)) << burst;
  EXPECT_TRUE(core.expects_known_burst(true));  // perhaps the accesses are more regular now
}

TEST(EarliestLastWrite, IsNeverLaterThanTheLastWrite) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::SplitMix64 random(seed);
    const Setting setting = random_setting(random);
    Core core(setting, Core::Way::kAhead);
    core.start(0);
    std::vector<std::uint64_t> earliest;
    while (!core.done()) {
      earliest.push_back(core.earliest_last_write());
      core.step();
    }
    const std::uint64_t last_write = core.cycle() - 1;
    ASSERT_LE(*std::max_element(earliest.begin(), earliest.end()), last_write);
    ASSERT_EQ(earliest.back(), last_write);
  }
}

TEST(EarliestLastWrite, IsTheLastWriteFromTheFirstSlotConsumedOnWhenUncontended) {
  const Setting setting = bank_for_each_port(16, 5);
  Core core(setting, Core::Way::kAhead);
  core.start(100);
  core.advance(100 + 4);  // the latencies of table and image
  const std::uint64_t last_write = core.earliest_last_write();
  core.advance(kNever);
  EXPECT_EQ(core.cycle(), last_write + 1);
}

}  // namespace
}  // namespace stereotlm::fpga
