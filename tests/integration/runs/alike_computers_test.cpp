// Steps of an explanation that share a simulation, beside the simulation of each.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/runs/explanation.h"

namespace stereotlm::runs {
namespace {

using platform::BoardConfig;

constexpr std::uint64_t kFrames = 12;

NamedFigures simulated(const BoardConfig& board) {
  PointSimulator simulator;
  return NamedFigures(simulator(explore::make_point(0, board, {true, kFrames, ""})));
}

struct Case {
  const char* preset;
  std::vector<std::string> sets;
};
void PrintTo(const Case& one, std::ostream* out) {
  *out << one.preset;
  for (const std::string& set : one.sets) *out << ' ' << set;
}

class AlikeComputers : public testing::TestWithParam<Case> {
 protected:
  static BoardConfig board() {
    std::vector<std::string> sets = {"image={width: 32, height: 24}", "cameras.frame_rate_hz=900"};
    sets.insert(sets.end(), GetParam().sets.begin(), GetParam().sets.end());
    return platform::load_board(GetParam().preset, sets);
  }
};

TEST_P(AlikeComputers, HaveTheFiguresOfTheirOwnSimulation) {
  const BoardConfig board = AlikeComputers::board();
  const platform::Tables tables = platform::identity_tables(board);
  Explanation found(board, tables, true, kFrames);
  ASSERT_TRUE(found.simulate({}));
  std::map<std::string, double> best;  // of each group, without loss
  for (const explore::KnobStep& step : found.knobs().possible) {
    if (step.group.empty()) continue;
    const NamedFigures its = simulated(step.board);
    if (its.integer("lost_pixels") > 0) continue;
    best[step.group] = std::max(best[step.group], its.real("frames_per_second.steady"));
  }
  for (const Explanation::Step& step : found.steps()) {
    SCOPED_TRACE(step.step->knob + " -> " + step.step->to);
    ASSERT_EQ(step.rate.failure, "");
    const NamedFigures its = simulated(step.step->board);
    EXPECT_EQ(step.rate.frames_per_second, its.real("frames_per_second.steady"));
    EXPECT_EQ(step.rate.uncertainty, its.real("frames_per_second.steady_uncertainty"));
    EXPECT_EQ(step.rate.lost_pixels, its.integer("lost_pixels"));
    EXPECT_EQ(step.rate.memory_mj, its.real("energy.memory_mj_per_frame"));
    if (best.count(step.step->group) > 0) {
      EXPECT_EQ(step.rate.frames_per_second, best[step.step->group]);
    }
    Explanation::BusiestBank busiest;
    std::int64_t most = -1;
    for (const platform::BankConfig& bank : step.step->board.banks) {
      const auto count = [&](const char* what) { return its.integer("banks." + bank.name + what); };
      if (count(".busy_cycles") <= most) continue;
      most = count(".busy_cycles");
      const std::int64_t reads = count(".reads");
      const std::int64_t writes = count(".writes");
      const bool separate = memory::has_separate_ports(bank.kind);
      busiest = {bank.name,
                 static_cast<double>(separate ? std::max(reads, writes) : reads + writes) / kFrames};
    }
    EXPECT_EQ(step.busiest.name, busiest.name);
    EXPECT_EQ(step.busiest.accesses_per_frame, busiest.accesses_per_frame);
  }
}

const char* const kSyncBurst = "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}";

INSTANTIATE_TEST_SUITE_P(
    Boards, AlikeComputers,
    testing::Values(Case{"fpl2003", {}}, Case{"fpl2003", {"fpga.arbitration=round_robin", kSyncBurst}},
                    Case{"fpl2003", {"allocation.left_lut=bank0", "allocation.right_lut=bank0"}},
                    Case{"fpl2003", {"allocation.left_lut=bank7", "ssram.default.kind=qdr"}},
                    Case{"fpl2003-triple", {}}, Case{"four-rows", {"pci.clock_mhz=8"}},
                    Case{"two-banks", {"fpga.arbitration=age"}}, Case{"sdram", {}}));

}  // namespace
}  // namespace stereotlm::runs
