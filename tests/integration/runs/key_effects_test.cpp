#include "sw/explore/optimise/key_effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/bounds.h"
#include "platform/figures/proven_rate.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/plan/knobs.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

TEST(KeyEffects, CoverEveryKey) {
  for (const platform::Key& key : platform::board_keys())
    EXPECT_NO_THROW(effects_of_key(key.path)) << key.path;
}

std::vector<std::uint64_t> cycles_of(const BoardConfig& board) {
  return platform::run_core(board, platform::identity_tables(board), 2).frame_cycles;
}

// A board has the same figures alone, and behind another one, whose run of the core it may share.
void expect_figures_behind(const BoardConfig& first, const BoardConfig& board) {
  runs::PointSimulator both;
  both(make_point(0, first, {}));
  const Figures behind = both(make_point(1, board, {}));
  const Figures alone = runs::PointSimulator()(make_point(1, board, {}));
  ASSERT_EQ(behind.values.size(), alone.values.size());
  for (std::size_t i = 0; i < alone.values.size(); ++i) {
    EXPECT_EQ(behind.values[i].path, alone.values[i].path);
    EXPECT_EQ(behind.values[i].value, alone.values[i].value) << alone.values[i].path;
  }
}

// A bank without a buffer matters to no frame, but has figures: sdram is refreshed.
TEST(KeyEffects, BanksWithoutABufferHaveFigures) {
  const std::vector<std::string> sets = {"image={width: 32, height: 24}", "allocation.left_lut=none",
                                         "allocation.right_lut=none"};
  const BoardConfig board = platform::load_board("fpl2003", sets);
  BoardConfig other = board;
  other.banks.back().kind = memory::BankKind::kSdram;
  other.banks.back().sdram.emplace();
  ASSERT_EQ(core_cycles_key(other), core_cycles_key(board));
  expect_figures_behind(board, other);
  expect_figures_behind(other, board);
}

// Of each change of one key of some boards: what the key does not change stays.
TEST(KeyEffects, WhatAKeyDoesNotChangeStays) {
  std::set<std::string> changed;
  for (const char* const preset :
       {"fpl2003", "fpl2003-syncburst", "sdram", "four-rows", "eight-banks-four-lanes"}) {
    const BoardConfig board = platform::load_board(preset, {"image={width: 32, height: 24}"});
    for (const KnobStep& step : knob_steps(board, true, std::nullopt).possible) {
      const platform::Key* const key = platform::find_key(platform::schema_path(step.knob));
      if (key == nullptr || !platform::has_value(*key)) continue;
      SCOPED_TRACE(std::string(preset) + ": " + step.knob + " -> " + step.to);
      const KeyEffects& effects = effects_of_key(key->path);
      // The step to the line buffer sets the rows too, and a kind of bank its timing.
      if (step.sets.size() > 1) continue;
      changed.insert(key->path);
      if (!effects.core_cycles) {
        EXPECT_EQ(cycles_of(step.board), cycles_of(board));
        EXPECT_EQ(core_cycles_key(step.board), core_cycles_key(board));
      }
      expect_figures_behind(board, step.board);
      if (!effects.area) {
        EXPECT_EQ(platform::area_of(step.board).slices, platform::area_of(board).slices);
      }
      if (!effects.pins) {
        EXPECT_EQ(platform::pins_of(step.board), platform::pins_of(board));
      }
      if (!effects.disparities) {
        EXPECT_FALSE(step.changes_disparities);
      }
      // Boards with the same key of their cycles take the same cycles.
      if (core_cycles_key(step.board) == core_cycles_key(board)) {
        EXPECT_EQ(cycles_of(step.board), cycles_of(board));
      }
    }
  }
  EXPECT_GT(changed.size(), 20U);
}

// Whether a figure is of what the core accesses, or of the board without a run.
bool is_of_core(const std::string& path) {
  const std::string section = path.substr(0, path.find('.'));
  static const std::set<std::string> kSections = {"ports", "banks", "energy",
                                                  "area",  "pins",  "smallest_device"};
  return kSections.count(section) > 0 || path.rfind("bound.", 0) == 0 ||
         path.rfind("frames_per_second.exact", 0) == 0;
}

// The boards of the steps, and some whose banks of results differ in what only the host notices.
std::vector<std::pair<std::string, BoardConfig>> variants_of(const BoardConfig& board) {
  std::vector<std::pair<std::string, BoardConfig>> boards = {{"itself", board}};
  for (const KnobStep& step : knob_steps(board, true, std::nullopt).possible)
    boards.emplace_back(step.knob + " -> " + step.to, step.board);
  for (const auto& [name, kind, turnaround] :
       {std::tuple("flow through", memory::BankKind::kZbtFlowThrough, 0),
        std::tuple("turnaround", memory::BankKind::kSyncBurst, 5)}) {
    BoardConfig other = board;
    for (platform::BankConfig& bank : other.banks) {
      const auto& results = board.allocation.disparity;
      if (std::none_of(results.begin(), results.end(),
                       [&bank](const auto& buffer) { return buffer.banks.front() == bank.name; }))
        continue;
      bank.kind = kind;
      bank.turnaround_cycles = turnaround;
    }
    boards.emplace_back(name, other);
  }
  return boards;
}

// Boards that have the same key: what the computer does is the same at each time.
TEST(KeyEffects, ComputersOfTheSameTimeDoTheSame) {
  const char* const kSyncBurst = "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}";
  const std::vector<std::pair<const char*, std::vector<std::string>>> boards = {
      {"fpl2003", {}},
      {"fpl2003", {"capture.destination=host_memory", "capture.host_frames=1"}},
      {"fpl2003", {"fpga.arbitration=round_robin", kSyncBurst}},
      {"fpl2003", {"allocation.left_lut=bank0", "allocation.right_lut=bank0"}},
      {"fpl2003", {"allocation.left_lut=bank7", "ssram.default.kind=qdr"}},
      {"fpl2003-triple", {"bridge.posted_words=4", "capture.fifo_words=8", "capture.fifo_trigger_words=4"}},
      {"four-rows", {"pci.clock_mhz=8"}},
      {"two-banks", {"fpga.arbitration=age"}}};
  std::size_t shared = 0;
  for (const auto& [preset, sets] : boards) {
    std::vector<std::string> all = {"image={width: 32, height: 24}", "cameras.frame_rate_hz=900"};
    all.insert(all.end(), sets.begin(), sets.end());
    const BoardConfig board = platform::load_board(preset, all);
    std::map<std::string, std::pair<std::string, Figures>> first;
    for (const auto& [change, its] : variants_of(board)) {
      const platform::Tables tables = platform::identity_tables(its);
      if (!platform::frames_are_apart(its, platform::frame_accesses(its, tables))) continue;
      const std::uint64_t turn = platform::allocation_period_frames(its);
      const std::string key = computer_time_key(
          its, platform::core_frame_cycles(its, platform::access_patterns(its, &tables), turn));
      const Figures figures = runs::PointSimulator()(make_point(0, its, {true, 12, ""}));
      const std::string name = std::string(preset) + ": " + change;
      const auto [of_key, is_first] = first.emplace(key, std::pair(name, figures));
      if (is_first) continue;
      SCOPED_TRACE(of_key->second.first + "; " + name);
      ++shared;
      std::map<std::string, platform::KeyValue> values;
      for (const platform::BoardValue& value : of_key->second.second.values) values[value.path] = value.value;
      for (const platform::BoardValue& value : figures.values) {
        if (is_of_core(value.path)) continue;
        EXPECT_EQ(value.value, values[value.path]) << value.path;
      }
    }
  }
  EXPECT_GT(shared, 100U);
}

}  // namespace
}  // namespace stereotlm::explore
