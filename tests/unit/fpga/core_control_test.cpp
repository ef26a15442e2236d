#include "models/fpga/core_control.h"

#include <gtest/gtest.h>

#include <stdexcept>

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
    match.consume();
  }
  for (std::uint64_t cycle = 0; cycle < geometry.drain_cycles; ++cycle) {
    EXPECT_TRUE(match.draining());
    EXPECT_TRUE(match.decide(false, true));
    EXPECT_FALSE(match.decide(false, false));
    match.consume();
  }
  EXPECT_FALSE(match.decide(true, true));
}

TEST(MatchControl, CompletesAWordWithTheColumnOfItsLastResult) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    CoreConfig config = core_of_two_rows(fetch);
    config.filter = kernels::log7();
    const FrameGeometry geometry(config);
    MatchControl match(geometry);
    for (int frame = 0; frame < 2; ++frame) {
      match.start_frame();
      std::uint64_t words = 0;
      const auto per_column = static_cast<std::uint64_t>(geometry.slots_per_column);
      for (std::uint64_t cycle = 0; cycle < geometry.slots + geometry.drain_cycles; ++cycle) {
        // Result i leaves when column i + C is complete; i mod 4 = 3 completes a word.
        const std::uint64_t column = cycle / per_column;
        const bool last_of_column = cycle % per_column == per_column - 1;
        const bool word = last_of_column && column >= geometry.result_delay_columns &&
                          (column - geometry.result_delay_columns) % 4 == 3;
        EXPECT_EQ(match.consume() && match.word_leaves(), word) << cycle;
        words += std::uint64_t{word};
      }
      EXPECT_EQ(words, geometry.result_words);
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
  result.commit(false, true);  // the first word enters: requested from the next cycle on
  expect(Intent::kRequest, true);
  result.commit(false, true);
  expect(Intent::kRequest, false);
  result.commit(true, true);  // a word enters and one leaves
  expect(Intent::kRequest, false);
  result.commit(true, false);
  expect(Intent::kRequest, true);
  result.commit(true, false);
  expect(Intent::kStarved, true);
}

TEST(ResultControl, IsDoneWithTheLastWordAndIdleThen) {
  const FrameGeometry geometry(core_of_two_rows());  // four words
  ResultControl result(geometry, 8);
  for (int frame = 0; frame < 2; ++frame) {
    result.start_frame();
    for (std::uint64_t word = 0; word < geometry.result_words; ++word) {
      result.commit(false, true);
      EXPECT_FALSE(result.frame_done());
      result.commit(true, false);
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

// Cycles of an uncontended frame without the latencies.
std::uint64_t work_of(const CoreControl& core) {
  return core.geometry().slots + core.geometry().drain_cycles + 1;
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
    std::uint64_t refused_cycles;  // before which the result port is refused
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
