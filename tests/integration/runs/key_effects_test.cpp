#include "sw/explore/optimise/key_effects.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
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

}  // namespace
}  // namespace stereotlm::explore
