#include "models/fpga/core_control.h"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

using memory::mask_of;
using memory::PortMask;

CoreConfig core_of_two_rows(Fetch fetch = Fetch::kColumn) { return small_core(8, 2, 2, fetch); }

TEST(MatchControl, NeedsSlotsUpToTheLastOneAndNoneInTheDrain) {
  const FrameGeometry geometry(core_of_two_rows());
  MatchControl match(geometry);
  match.start_frame();
  for (std::uint64_t slot = 0; slot < geometry.slots; ++slot) {
    EXPECT_FALSE(match.draining());
    EXPECT_TRUE(match.decide(true, true));
    EXPECT_FALSE(match.decide(false, true));
    EXPECT_FALSE(match.decide(true, false));
    EXPECT_TRUE(match.consumes());
    match.work();
  }
  for (std::uint64_t cycle = 0; cycle < geometry.drain_cycles; ++cycle) {
    EXPECT_TRUE(match.draining());
    EXPECT_TRUE(match.decide(false, true));
    EXPECT_FALSE(match.decide(false, false));
    EXPECT_TRUE(match.consumes());
    match.work();
  }
  EXPECT_FALSE(match.decide(true, true));
}

// Two passes and the rest: S = 3 of contract 7.1.
CoreConfig core_of_three_passes() {
  CoreConfig config = small_core(8, 2, 8);
  config.units = 3;
  return config;
}

TEST(MatchControl, ChecksSlotsAndQueueOnlyInTheFirstPassAndConsumesInTheLast) {
  const FrameGeometry geometry(core_of_three_passes());
  MatchControl match(geometry);
  for (int frame = 0; frame < 2; ++frame) {
    match.start_frame();
    const std::uint64_t worked_before = match.worked();
    const std::uint64_t cycles = 3 * (geometry.slots + geometry.drain_cycles);
    for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
      EXPECT_EQ(match.draining(), cycle >= 3 * geometry.slots);
      EXPECT_EQ(match.cycles_left(), cycles - cycle);
      EXPECT_EQ(match.worked() - worked_before, cycle);
      EXPECT_TRUE(match.decide(true, true));
      EXPECT_EQ(match.decide(true, false), cycle % 3 != 0);
      EXPECT_EQ(match.decide(false, false), cycle % 3 != 0);
      EXPECT_EQ(match.decide(false, true), cycle % 3 != 0 || match.draining());
      EXPECT_EQ(match.consumes(), cycle % 3 == 2);
      EXPECT_EQ(match.work() && match.words_leaving() > 0,
                cycle + 1 == cycles - 3 * 3 * 12 || cycle + 1 == cycles - 3 * 3 * 8 ||
                    cycle + 1 == cycles - 3 * 3 * 4 || cycle + 1 == cycles)
          << cycle;
    }
    EXPECT_FALSE(match.decide(true, true));
  }
}

// Both ways to fetch, passes, rows, and heights that are a multiple of the rows or not.
std::vector<CoreConfig> cores_with_words() {
  std::vector<CoreConfig> cores;
  for (const int height : {1, 2, 5, 6, 8}) {
    for (const int rows : {1, 2, 3, 4, 16}) {
      for (const int units : {2, 1}) {
        CoreConfig config = small_core(8, height, 2);
        config.filter = kernels::log7();
        config.units = units;
        config.rows = rows;
        config.result_fifo_words = 16;
        cores.push_back(config);
      }
    }
    cores.push_back(small_core(8, height, 2, Fetch::kLineBuffer));
  }
  return cores;
}

TEST(MatchControl, CompletesAWordOfEachRowInsideTheImageWithEveryFourthResultOfAStrip) {
  for (const CoreConfig& config : cores_with_words()) {
    const FrameGeometry geometry(config);
    MatchControl match(geometry);
    for (int frame = 0; frame < 2; ++frame) {
      match.start_frame();
      int words = 0;
      for (std::uint64_t cycle = 0; match.cycles_left() > 0; ++cycle) {
        const auto per_column = static_cast<std::uint64_t>(geometry.slots_per_column * geometry.passes);
        const auto result = static_cast<std::int64_t>(cycle / per_column) -
                            static_cast<std::int64_t>(geometry.result_delay_columns);
        const bool completes = cycle % per_column == per_column - 1 && result >= 0 && result % 4 == 3;
        int expected = 0;
        for (int row = 0; completes && row < config.rows; ++row)
          expected += int{result / config.width * config.rows + row < config.height};
        ASSERT_EQ(match.work() ? match.words_leaving() : 0, expected) << cycle;
        words += expected;
        ASSERT_EQ(match.words(), static_cast<std::uint64_t>(words)) << cycle;
      }
      EXPECT_EQ(words, config.width * config.height / 4);
    }
  }
}

// A group of four columns repeats one before it only if it completes as many words.
TEST(MatchControl, ChangesItsPartWhereTheWordsOfAGroupChangeAndIsUniformUpToThere) {
  for (const CoreConfig& config : cores_with_words()) {
    MatchControl match{FrameGeometry(config)};
    match.start_frame();
    std::map<std::uint64_t, int> words_from;  // [part]
    std::uint64_t part = match.part();
    std::uint64_t change = match.consumed() + match.uniform_slots();
    while (match.cycles_left() > 0) {
      bool completes = false;
      do {
        ASSERT_EQ(match.consumed() + match.uniform_slots(), change);
        completes = match.work();
        if (match.consumed() == change) change += match.uniform_slots();
      } while (!completes);
      const int words = match.words_leaving();
      if (match.part() == part) {
        EXPECT_EQ(words_from.emplace(part, words).first->second, words);
      }
      part = match.part();
    }
  }
}

// Every state of a frame, and skips of any length within a part.
TEST(MatchControl, IsAfterASkipAsIfItHadWorked) {
  for (const CoreConfig& config : cores_with_words()) {
    const FrameGeometry geometry(config);
    const auto group = static_cast<std::uint64_t>(4 * geometry.slots_per_column);
    const auto phase =
        geometry.result_delay_columns % 4 * static_cast<std::uint64_t>(geometry.slots_per_column);
    MatchControl match(geometry);
    match.start_frame();
    test::SplitMix64 random(1);
    while (match.cycles_left() > 0) {
      MatchControl worked = match;
      const std::uint64_t end = match.consumed() + match.uniform_slots();
      for (int cycles = random.between(0, 200); cycles > 0 && worked.consumed() < end; --cycles)
        worked.work();
      match.skip_to(worked.state(), worked.consumed() - match.consumed());
      ASSERT_EQ(match.state(), worked.state());
      ASSERT_EQ(match.cycles_left(), worked.cycles_left());
      ASSERT_EQ(match.columns(), worked.columns());
      ASSERT_EQ(match.slots_of_group_left(), group - (match.consumed() + group - phase) % group);
      if (match.cycles_left() > 0) match.work();
    }
  }
}

TEST(ResultControl, RequestsAndHasRoomByTheWordsInItsQueue) {
  ResultControl result(FrameGeometry(core_of_two_rows()), 2);
  result.start_frame();
  const auto expect = [&result](Intent intent, bool has_room) {
    EXPECT_EQ(result.decide(), intent);
    EXPECT_EQ(result.has_room(), has_room);
  };
  expect(Intent::kIdle, true);
  result.commit(false, 1);  // the first word enters: requested from the next cycle on
  expect(Intent::kRequest, true);
  result.commit(false, 1);
  expect(Intent::kRequest, false);
  result.commit(true, 1);  // a word enters and one leaves
  expect(Intent::kRequest, false);
  result.commit(true, 0);
  expect(Intent::kRequest, true);
  result.commit(true, 0);
  expect(Intent::kStarved, true);
}

TEST(ResultControl, HasRoomForAWordOfEachRowOnly) {
  CoreConfig config = core_of_two_rows();
  config.rows = 3;
  for (const int places : {3, 4, 6}) {
    ResultControl result(FrameGeometry(config), places);
    result.start_frame();
    for (int words = 0; words < places; ++words) {
      EXPECT_EQ(result.has_room(), places - words >= 3) << words;
      result.commit(false, 1);
    }
    EXPECT_FALSE(result.has_room());
    EXPECT_EQ(result.most_queued(), places);
  }
  ResultControl result(FrameGeometry(config), 6);
  result.start_frame();
  result.commit(false, 3);
  EXPECT_TRUE(result.has_room());
  result.commit(true, 3);  // three words enter and one leaves
  EXPECT_FALSE(result.has_room());
  EXPECT_EQ(result.most_queued(), 5);
  result.commit(true, 0);
  EXPECT_FALSE(result.has_room());
  result.commit(true, 0);
  EXPECT_TRUE(result.has_room());
}

TEST(ResultControl, IsDoneWithTheLastWordAndIdleThen) {
  const FrameGeometry geometry(core_of_two_rows());  // four words
  ResultControl result(geometry, 8);
  for (int frame = 0; frame < 2; ++frame) {
    result.start_frame();
    for (std::uint64_t word = 0; word < geometry.result_words; ++word) {
      result.commit(false, 1);
      EXPECT_FALSE(result.frame_done());
      result.commit(true, 0);
    }
    EXPECT_TRUE(result.frame_done());
    EXPECT_EQ(result.decide(), Intent::kIdle);
  }
}

// Steps a core whose requests are all granted, except those in `refused`, until the frame is done; returns
// the cycles.
std::uint64_t run_frame(CoreControl& core, PortMask refused = 0, std::uint64_t refused_cycles = 0) {
  std::uint64_t cycles = 0;
  while (!core.frame_done() && cycles < 10'000) {
    const CoreControl::Decision decision = core.decide();
    const PortMask requests = decision.requests();
    const auto granted = cycles < refused_cycles ? static_cast<PortMask>(requests & ~refused) : requests;
    core.commit(decision, granted, {true, true});
    core.count_host(false, false);
    ++cycles;
  }
  return cycles;
}

// Cycles of an uncontended frame without the latencies: the passes, and the writes of the last words.
std::uint64_t work_of(const CoreControl& core) {
  const FrameGeometry& geometry = core.geometry();
  return (geometry.slots + geometry.drain_cycles) * static_cast<std::uint64_t>(geometry.passes) +
         static_cast<std::uint64_t>(geometry.last_rows);
}

TEST(CoreControl, TakesTheLatenciesTheSlotsTheDrainAndTheLastWrite) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    CoreControl core(core_of_two_rows(fetch));
    core.start_frame({2, 2, 2, 2});
    EXPECT_EQ(run_frame(core), 4 + work_of(core));
    core.start_frame({1, 2, 1, 1});  // the slower side decides
    EXPECT_EQ(run_frame(core), 3 + work_of(core));
    core.start_frame({1, 1, 1, 1});
    EXPECT_EQ(run_frame(core), 2 + work_of(core));
  }
}

TEST(CoreControl, TakesItsPassesAndTheWritesOfTheLastStrip) {
  for (const int units : {8, 7, 4, 3, 1}) {
    for (const int rows : {1, 2, 3, 5}) {
      CoreConfig config = small_core(8, 5, 8);
      config.units = units;
      config.rows = rows;
      config.result_fifo_words = 2 * rows;
      CoreControl core(config);
      EXPECT_EQ(core.geometry().passes, units == 8 ? 1 : units == 1 ? 8 : units == 3 ? 3 : 2);
      EXPECT_EQ(core.geometry().last_rows, rows == 3 ? 2 : rows == 5 ? 5 : 1);
      for (int frame = 0; frame < 2; ++frame) {
        core.start_frame({2, 2, 2, 2});
        EXPECT_EQ(run_frame(core), 4 + work_of(core)) << units << ' ' << rows;
      }
    }
  }
}

// R words leave the matcher at once. With F places it begins again when F - R of them are left, after 2 R - F
// writes.
TEST(CoreControl, WaitsUntilTheQueueHasAPlaceForEachRow) {
  for (const int rows : {1, 2, 4}) {
    for (int places = rows; places <= 2 * rows; ++places) {
      CoreConfig config = small_core(8, 4 * rows, 8);
      config.rows = rows;
      config.result_fifo_words = places;
      CoreControl core(config);
      core.start_frame({1, 1, 1, 1});
      const std::uint64_t groups = core.geometry().result_words / static_cast<std::uint64_t>(rows);
      const auto waits = static_cast<std::uint64_t>(2 * rows - places);
      EXPECT_EQ(run_frame(core), 2 + work_of(core) + (groups - 1) * waits) << rows << ' ' << places;
    }
  }
}

TEST(CoreControl, NeedsNoTableLatencyWithoutTables) {
  for (const bool right_table : {true, false}) {
    CoreConfig config = core_of_two_rows();
    config.left_table = false;
    config.right_table = right_table;
    CoreControl core(config);
    core.start_frame({2, 2, 2, 2});
    EXPECT_EQ(run_frame(core), (right_table ? 4 : 2) + work_of(core));
    EXPECT_EQ(core.port_cycles(lut_port(Side::kLeft)).idle(), (right_table ? 4 : 2) + work_of(core));
  }
}

TEST(CoreControl, StopsTheMatcherOnlyWhileTheResultQueueIsFull) {
  struct Queue {
    int words;
    std::uint64_t refused_cycles;  // the result port is refused in all cycles before this one
    std::uint64_t cycles;
    std::uint64_t stalls;
  };
  const FrameGeometry geometry(core_of_two_rows());
  const std::uint64_t uncontended = 2 + geometry.slots + geometry.drain_cycles + 1;
  // The lanes are consumed from cycle 2 on; the first word enters at the end of this cycle.
  const std::uint64_t first_word = 2 + (geometry.result_delay_columns + 4) * 3 - 1;
  // One place: the queue is full in the cycle in which each word is written, the last one stops nothing.
  const std::uint64_t one_place = uncontended + geometry.result_words - 1;
  for (const Queue& queue : {Queue{1, 0, one_place, 0}, Queue{1, first_word + 1, one_place, 0},
                             Queue{1, first_word + 2, one_place + 1, 1}, Queue{2, 0, uncontended, 0},
                             Queue{2, first_word + 3, uncontended, 2}}) {
    CoreConfig config = core_of_two_rows();
    config.result_fifo_words = queue.words;
    CoreControl core(config);
    core.start_frame({1, 1, 1, 1});
    EXPECT_EQ(run_frame(core, mask_of(kResultPort), queue.refused_cycles), queue.cycles);
    EXPECT_EQ(core.port_cycles(kResultPort).stalled(), queue.stalls);
  }
}

TEST(CoreControl, RefusesAConfigurationWithProblems) {
  CoreConfig config = core_of_two_rows();
  config.window = 4;
  EXPECT_THROW(CoreControl{config}, std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::fpga
