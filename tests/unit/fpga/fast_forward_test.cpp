// Bursts of the host in frames that run ahead, compared with frames that are stepped; and how few cycles are
// stepped. The random cores, boards and computers compare what is counted with the plain loops.
#include "models/fpga/fast/fast_forward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "models/fpga/frame_run.h"
#include "models/kernels/rectification_table.h"
#include "tests/unit/fpga/core_figures.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// The board of the paper without filter and with a word cache: joint tables in one bank, pictures and
// disparities in another.
class FastForwardTest : public testing::Test {
 protected:
  static CoreConfig config() {
    CoreConfig config;
    config.filter.reset();
    config.joint_tables = true;
    config.pixel_cache = PixelCache::kWord;
    return config;
  }
  FastForwardTest() {
    bases.fill(registers::base(1, 0));
    bases[0] = registers::base(0, 0);
  }
  // The number of cycles that are stepped in each of three frames. Between two bursts of 32 words to the bank
  // of the tables the host pauses for `pause` cycles; 0: no bursts.
  std::vector<std::uint64_t> stepped_cycles(std::uint64_t pause) {
    std::vector<std::uint64_t> stepped;
    for (int frame = 0; frame < 3; ++frame) {
      const std::uint64_t begin = run.cycle() - run.skipped_cycles();
      run.start_direct(run.cycle(), bases, patterns);
      for (std::uint64_t first = run.cycle() + 10'000; pause != 0 && !run.control().frame_done();
           first += pause) {
        for (std::size_t left = 32; left > 0 && !run.control().frame_done();) {
          const FastForward::Served served = run.serve_host({0, true}, first, left);
          left -= served.words;
          if (served.words != 0) first = served.last_cycle + 1;
        }
      }
      run.run_ahead(UINT64_MAX);
      stepped.push_back(run.cycle() - run.skipped_cycles() - begin);
      run.finish();
      run.end();
    }
    return stepped;
  }

  FrameBases bases{};
  std::vector<memory::SsramBankConfig> banks = std::vector<memory::SsramBankConfig>(2);
  memory::Arbitration arbitration{core_arbiter(), banks};
  FrameRun run{config(), banks, arbitration, UINT64_MAX};
  AccessPatterns patterns{AccessPattern(FrameGeometry(config()), PixelCache::kWord),
                          AccessPattern(FrameGeometry(config()), PixelCache::kWord)};
};

// A frame has 2.15 million cycles. Those around its first row, its last row and its end are always stepped.
TEST_F(FastForwardTest, StepsFewCyclesOfAFrame) {
  for (const std::uint64_t cycles : stepped_cycles(0)) EXPECT_LT(cycles, 1000U);
}

TEST_F(FastForwardTest, StepsFewCyclesOfAFrameWithIrregularTablesOnceItsTransitionsAreRecorded) {
  std::vector<std::uint32_t> slanted(640 * 480);
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      slanted[place_of(config(), column, row)] = kernels::make_entry(
          std::min(639, column + column / 100 + row / 70), std::min(479, row + column / 80));
    }
  }
  patterns[0].set_entries(slanted.data());
  const std::vector<std::uint64_t> stepped = stepped_cycles(0);
  EXPECT_LT(stepped[0], 50'000U);
  EXPECT_LT(stepped[1], 1000U);
  EXPECT_EQ(stepped[2], stepped[1]);
}

// The bursts begin in many phases of a group of four columns.
TEST_F(FastForwardTest, StepsFewCyclesBesideBurstsOnceTheirGroupsAreRecorded) {
  const std::vector<std::uint64_t> stepped = stepped_cycles(901);
  EXPECT_LT(stepped[0], 50'000U);
  EXPECT_LT(stepped[2], 4000U);
}

// The number of cycles that are stepped in each of two frames without bursts. Every pixel is its own source.
std::vector<std::uint64_t> stepped_cycles(const CoreConfig& config,
                                          const std::vector<memory::SsramBankConfig>& banks,
                                          const FrameBases& bases) {
  memory::ArbiterConfig arbiter;
  arbiter.priority.resize(CorePorts(config).size());
  std::iota(arbiter.priority.begin(), arbiter.priority.end(), memory::Port{0});
  memory::Arbitration arbitration(arbiter, banks);
  FrameRun run(config, banks, arbitration, UINT64_MAX);
  const kernels::RectificationTable table = kernels::identity_table(config.width, config.height);
  AccessPatterns patterns{AccessPattern(FrameGeometry(config), config.pixel_cache),
                          AccessPattern(FrameGeometry(config), config.pixel_cache)};
  for (AccessPattern& pattern : patterns) pattern.set_entries(table.entries.data());
  std::vector<std::uint64_t> stepped;
  for (int frame = 0; frame < 2; ++frame) {
    const std::uint64_t begin = run.cycle() - run.skipped_cycles();
    run.start_direct(run.cycle(), bases, patterns);
    run.run_ahead(UINT64_MAX);
    stepped.push_back(run.cycle() - run.skipped_cycles() - begin);
    run.finish();
    run.end();
  }
  return stepped;
}

// The preset eight-banks-four-lanes: a frame has 614,593 cycles.
TEST(FastForwardStripes, StepsFewCyclesOfAFrame) {
  CoreConfig config;
  config.lanes = 4;
  config.joint_tables = true;
  config.pixel_cache = PixelCache::kWord;
  FrameBases bases{};
  const auto stripe = [&config](std::uint32_t first_bank, std::uint32_t word) {
    std::vector<std::uint32_t> parts;
    for (std::uint32_t part = 0; part < 4; ++part) parts.push_back(registers::base(first_bank + part, word));
    config.stripes.push_back(parts);
    return parts.front();
  };
  bases[lut_group(Side::kLeft)] = stripe(0, 0);
  bases[pixel_group(Side::kLeft)] = stripe(4, 0);
  bases[pixel_group(Side::kRight)] = stripe(4, 19'200);
  bases[kResultGroup] = stripe(4, 38'400);
  const std::vector<std::uint64_t> stepped =
      stepped_cycles(config, std::vector<memory::SsramBankConfig>(8), bases);
  EXPECT_LT(stepped[0], 40'000U);
  EXPECT_LT(stepped[1], 1000U);
}

// The preset sdram: a frame has 489,172 cycles, and 782 refreshes of both banks, which come at other places
// in each frame.
TEST(FastForwardSdram, StepsFewCyclesOfAFrame) {
  CoreConfig config;
  config.fetch = Fetch::kLineBuffer;
  config.joint_tables = true;
  config.pixel_cache = PixelCache::kWord;
  memory::SsramBankConfig bank;
  bank.kind = memory::BankKind::kSdram;
  bank.sdram = memory::SdramTiming{};
  FrameBases bases{};
  bases[kResultGroup] = registers::base(0, 307'200);
  bases[pixel_group(Side::kLeft)] = registers::base(1, 0);
  bases[pixel_group(Side::kRight)] = registers::base(1, 76'800);
  const std::vector<std::uint64_t> stepped = stepped_cycles(config, {bank, bank}, bases);
  EXPECT_LT(stepped[0], 40'000U);
  EXPECT_LT(stepped[1], 20'000U);
}

// A core with random entries whose frames run ahead, or are stepped.
class Core {
 public:
  Core(test::SplitMix64 random, bool steps) : steps_(steps) {
    CoreConfig config = random_core(random, 64);
    draw_units(random, config);
    draw_rows(random, config);
    const memory::ArbiterConfig arbiter = random_arbiter(random);
    std::vector<memory::SsramBankConfig> banks;
    for (int left = random.between(1, 6); left > 0; --left) banks.push_back(random_bank(random));
    for (std::uint32_t& base : bases_)
      base = registers::base(static_cast<std::uint32_t>(random.between(0, int(banks.size()) - 1)), 0);
    for (AccessPattern& pattern : patterns_) pattern = {FrameGeometry(config), config.pixel_cache};
    for (const Side side : kSides) {
      entries_[index_of(side)] = random_entries(random, config);
      if (side == Side::kLeft ? config.left_table : config.right_table)
        patterns_[index_of(side)].set_entries(entries_[index_of(side)].data());
    }
    arbitration_.emplace(arbiter, banks);
    run_.emplace(config, banks, *arbitration_, UINT64_MAX);
    if (random.chance(30)) run_->record_rows();
  }
  void start() {
    if (steps_) return run_->start_stepped(run_->cycle(), bases_);
    run_->start_direct(run_->cycle(), bases_, patterns_);
  }
  void advance(std::uint64_t end) {
    if (!steps_) run_->run_ahead(end);
    while (run_->cycle() < end && !done()) step(false);
  }
  // Returns the cycle of the last grant. Each word requests in the cycle after a grant.
  std::uint64_t serve(std::uint64_t first, FastForward::Route route, std::size_t words) {
    if (steps_) return serve_stepped(first, route, words);
    std::uint64_t last = first;
    while (words > 0 && !done()) {
      const FastForward::Served served = run_->serve_host(route, first, words);
      words -= served.words;
      route.word += static_cast<std::uint32_t>(served.words);
      if (served.words != 0) first = 1 + (last = served.last_cycle);
    }
    return last;
  }
  void finish() {
    advance(UINT64_MAX);
    run_->finish();
    run_->end();
  }
  bool done() const { return run_->control().frame_done(); }
  std::uint64_t cycle() const { return run_->cycle(); }
  std::size_t banks() const { return arbitration_->banks(); }
  std::string figures() {
    CoreFigures figures(*run_, *arbitration_);
    for (const RowProfile& frame : run_->take_rows()) figures.add(frame);
    return figures.text();
  }

 private:
  std::uint64_t serve_stepped(std::uint64_t first, FastForward::Route route, std::size_t words) {
    advance(first);
    if (done()) return first;
    arbitration_->route(kHostGroup, route.bank, route.write);
    for (; words > 0 && !done();) {
      if (memory::has(arbitration_->placed(), kHostGroup))
        arbitration_->place(kHostGroup, route.bank, route.word);
      if (!step(true)) continue;
      --words;
      ++route.word;
      first = run_->cycle() - 1;
    }
    arbitration_->unroute(kHostGroup);
    return first;
  }
  bool step(bool requests) {
    const CoreControl& control = run_->control();
    const auto pattern = [&](std::size_t lane) -> const AccessPattern& {
      return patterns_[index_of(control.side_of(lane))];
    };
    const auto needs_pixel = [&](const CoreControl::Decision& /*decision*/, memory::PortMask granted) {
      PixelNeeds needs = 0;
      for (std::size_t lane = 0; lane < control.lanes().size(); ++lane) {
        const SlotCursor& slot = control.lane(lane).next_slot();
        if (memory::has(granted, control.table_port(lane)) &&
            pattern(lane).needs_pixel(slot.column(), slot.row()))
          needs |= PixelNeeds{1} << lane;
      }
      return needs;
    };
    const auto entry = [&](std::size_t lane) {
      SlotCursor slot = control.lane(lane).first_slot();
      slot.advance(control.lane(lane).handled());
      return pattern(lane).entry(slot.column(), slot.row());
    };
    return memory::has(run_->step(requests, needs_pixel, entry), kHostGroup);
  }

  bool steps_;
  FrameBases bases_{};
  std::array<std::vector<std::uint32_t>, 2> entries_;
  AccessPatterns patterns_{AccessPattern(FrameGeometry(CoreConfig()), PixelCache::kWord),
                           AccessPattern(FrameGeometry(CoreConfig()), PixelCache::kWord)};
  std::optional<memory::Arbitration> arbitration_;
  std::optional<FrameRun> run_;
};

// Most bursts are like each other, so that they are soon known.
TEST(FastForward, GrantsBurstsInTheCyclesOfItsSteps) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Core stepped(test::SplitMix64(seed), true);
    Core ahead(test::SplitMix64(seed), false);
    test::SplitMix64 random(seed);
    const int words = random.mostly_small(1, 40, 300);
    const int pause = random.mostly_small(1, 200, 1000);
    const int others = random.chance(50) ? 0 : random.between(1, 30);  // percent
    for (int frame = 0; frame < 3; ++frame) {
      stepped.start();
      ahead.start();
      for (std::uint64_t first = stepped.cycle() + 50; !stepped.done();) {
        const bool is_other = random.chance(others);
        const FastForward::Route route{is_other ? random.next() % stepped.banks() : 0, !is_other};
        const int count = is_other ? random.between(1, 40) : words;
        const std::uint64_t waits = random.chance(others / 4) ? random.next() % 500 : 0;
        const auto serve = [&](Core& core) {
          const auto size = static_cast<std::size_t>(count);
          const std::uint64_t last = core.serve(std::max(first, core.cycle()) + waits, route, size);
          if (pause % 2 == 0) core.advance(last + static_cast<std::uint64_t>(pause / 2));
          return last;
        };
        const std::uint64_t last = serve(stepped);
        ASSERT_EQ(serve(ahead), last);
        ASSERT_EQ(ahead.cycle(), stepped.cycle());
        first = std::max(last, stepped.cycle()) + static_cast<std::uint64_t>(pause);
      }
      stepped.finish();
      ahead.finish();
      ASSERT_EQ(ahead.figures(), stepped.figures()) << "frame " << frame;
    }
  }
}

// FrameRun::earliest_last_write(), which tells the fast core when it has to check next whether the frame has
// ended.
struct LastWrite {
  const char* name;
  int units;
  int rows;
  bool shares_banks;  // ports wait: the matcher does not work in every cycle
};
void PrintTo(const LastWrite& core, std::ostream* out) { *out << core.name; }

class EarliestLastWrite : public testing::TestWithParam<LastWrite> {
 protected:
  EarliestLastWrite() {
    config.width = 32;
    config.height = 24;
    config.disparities = 16;
    config.units = GetParam().units;
    config.rows = GetParam().rows;
    std::uint32_t bank = 0;
    for (std::uint32_t& base : bases) base = registers::base(GetParam().shares_banks ? 0 : bank++, 0);
    arbiter.priority.resize(CorePorts(config).size());
    std::iota(arbiter.priority.begin(), arbiter.priority.end(), memory::Port{0});
  }
  // Steps a frame: the bound at the beginning of each cycle.
  void step_frame() {
    memory::Arbitration arbitration(arbiter, banks);
    FrameRun run(config, banks, arbitration, UINT64_MAX);
    const AccessPattern pattern(FrameGeometry(config), config.pixel_cache);
    const AccessPatterns patterns{pattern, pattern};
    run.start_direct(0, bases, patterns);
    while (!run.control().frame_done()) {
      bounds[run.cycle()] = run.earliest_last_write();
      const std::uint64_t writes = run.writes();
      run.run_ahead(run.cycle() + 1);
      if (run.writes() > writes) last_write = run.cycle() - 1;
    }
    run.finish();
    done_after_write = run.done_cycle() - last_write;
  }
  // Runs a frame ahead, with a word of the host every `pause` cycles: the bounds behind each word, of which
  // the core knows the state only of an earlier cycle.
  void run_beside_host(std::uint64_t pause) {
    bounds.clear();
    memory::Arbitration arbitration(arbiter, banks);
    FrameRun run(config, banks, arbitration, UINT64_MAX);
    const AccessPattern pattern(FrameGeometry(config), config.pixel_cache);
    const AccessPatterns patterns{pattern, pattern};
    run.start_direct(0, bases, patterns);
    for (std::uint64_t cycle = pause; !run.control().frame_done(); cycle += pause) {
      const FastForward::Served served = run.serve_host({0, true}, cycle, 1);
      if (served.words != 0) cycle = served.last_cycle + 1;
      bounds[run.cycle()] = run.earliest_last_write();
    }
    run.finish();
    last_write = run.done_cycle() - done_after_write;
  }

  CoreConfig config;
  FrameBases bases{};
  memory::ArbiterConfig arbiter;
  std::vector<memory::SsramBankConfig> banks = std::vector<memory::SsramBankConfig>(5);
  std::map<std::uint64_t, std::uint64_t> bounds;  // [cycle]
  std::uint64_t last_write = 0;
  std::uint64_t done_after_write = 0;  // cycles
};

TEST_P(EarliestLastWrite, IsNeverLateAndExactAtTheEnd) {
  step_frame();
  const auto folds = static_cast<std::uint64_t>(folds_of(config));
  for (const auto& [cycle, bound] : bounds) {
    if (cycle > last_write) continue;
    ASSERT_LE(bound, last_write) << "in cycle " << cycle;
    // Where no port waits, all that is unknown is the place within a step.
    if (!GetParam().shares_banks && cycle > 200) {
      ASSERT_GE(bound + folds, last_write) << "in cycle " << cycle;
    }
  }
  EXPECT_EQ(bounds[last_write], last_write);
  for (const std::uint64_t pause : {5U, 7U, 100U}) {
    run_beside_host(pause);
    for (const auto& [cycle, bound] : bounds) {
      if (cycle <= last_write) {
        ASSERT_LE(bound, last_write) << "in cycle " << cycle << ", pause " << pause;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cores, EarliestLastWrite,
                         testing::Values(LastWrite{"OneCycleAStep", 16, 1, false},
                                         LastWrite{"SixteenCyclesAStep", 1, 1, false},
                                         LastWrite{"ThreeCyclesAStep", 6, 1, true},
                                         LastWrite{"FourRows", 16, 4, false},
                                         LastWrite{"FourRowsOfSixCyclesAStep", 3, 4, true}),
                         [](const auto& core) { return core.param.name; });

}  // namespace
}  // namespace stereotlm::fpga
